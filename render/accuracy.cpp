// (theory.md, "The error without a reference")
#include "render/accuracy.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/error.h"
#include "libcore/base/number_text.h"
#include "libcore/tool/progress.h"

namespace lacuna {
namespace {

constexpr double kRoundFigures[] = {0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001};
constexpr double kTable[] = {0.2, 0.1, 0.05, 0.02, 0.01};

template <class... Values>
std::string text(const char* format, Values... values) {
    char line[256];
    std::snprintf(line, sizeof line, format, values...);
    return line;
}

/// An error as text: mape in per cent, other measures as they are.
std::string figure(const std::string& measure, double error, const char* digits) {
    return measure == "mape" ? text((std::string(digits) + " %%").c_str(), 100.0 * error)
                             : text(digits, error);
}

}  // namespace

UntilRequest parseUntil(const std::string& option) {
    const std::size_t sign = option.find('=');
    const std::string measure = option.substr(0, sign);
    const std::optional<double> error =
        parseNumber(sign == std::string::npos ? "" : option.substr(sign + 1));
    if (!ErrorEstimate{}.find(measure) || !error || !(*error > 0.0)) {
        throw UsageError(
            "--until: expected mape, relmse or rmse and an error above 0 such as mape=0.05, found "
            "'" +
            option + "'");
    }
    return {measure, *error};
}

double ErrorNow::secondsTo(double bound) const {
    return seconds * std::pow(error / bound, measure == "relmse" ? 1.0 : 2.0);
}

ErrorNow ErrorNow::after(double moreSeconds) const {
    ErrorNow later = *this;
    if (!(seconds > 0.0)) return later;
    later.seconds += moreSeconds;
    later.error *= std::pow(seconds / later.seconds, measure == "relmse" ? 1.0 : 0.5);
    return later;
}

std::string accuracyText(const ErrorNow& now, double bound) {
    const std::string error = now.measure + " " + figure(now.measure, now.error, "%.2g");
    if (!std::isfinite(now.error)) return now.measure + " not known yet";
    if (now.doubtful) return error + " at least";
    double next = bound;
    if (now.measure == "mape") {
        for (const double round : kRoundFigures) {
            if (round >= now.error) continue;
            next = std::max(bound, round);
            break;
        }
    }
    if (!(next > 0.0) || next >= now.error) return error;
    return error + ", " + figure(now.measure, next, "%.3g") + " in " +
           durationText(now.secondsTo(next) - now.seconds);
}

std::string costTable(const AccuracyCost& cost) {
    std::string table = text("%s: %d x %d pixels, %s, mape %.2g %% after %llu iterations, %.3g s\n",
                             cost.scene.c_str(), cost.width, cost.height, cost.method.c_str(),
                             100.0 * cost.now.error,
                             static_cast<unsigned long long>(cost.iterations), cost.now.seconds);
    if (!cost.doubt.empty()) {
        return table + "what accuracy costs cannot be promised yet: " + cost.doubt + "\n";
    }
    table += text(" mape    seconds  (setup %.3g s apart)\n", cost.setupSeconds);
    for (const double bound : kTable) {
        table += text("%4g %% %10.3g  %s\n", 100.0 * bound, cost.now.secondsTo(bound),
                      durationText(cost.now.secondsTo(bound)).c_str());
    }
    return table;
}

nlohmann::json costJson(const AccuracyCost& cost) {
    using nlohmann::json;
    json rows = json::array();
    for (const double bound : kTable) {
        const double seconds = cost.now.secondsTo(bound);
        if (cost.doubt.empty()) rows.push_back({{"mape", bound}, {"seconds", seconds}});
    }
    json j{{"scene", cost.scene},
           {"method", cost.method},
           {"width", cost.width},
           {"height", cost.height},
           {"iterations", cost.iterations},
           {"seconds", cost.now.seconds},
           {"setup_seconds", cost.setupSeconds},
           {"mape", std::isfinite(cost.now.error) ? json(cost.now.error) : json("nan")},
           {"promised", cost.doubt.empty()},
           {"costs", rows}};
    if (!cost.doubt.empty()) j["doubt"] = cost.doubt;
    return j;
}

}  // namespace lacuna
