#include "render/study/choices.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "libcore/base/text_list.h"
#include "render/study/band.h"

namespace lacuna {
namespace {

constexpr Axis kAxis = Axis::SecondsWithSetup;
constexpr double kAsGood = 1.1;  // largest negligible regret

using Runs = std::vector<const RunResult*>;

bool choseForItself(const Runs& runs) {
    return !runs.empty() && std::ranges::all_of(runs, [](const RunResult* r) {
        return r->report.contains("chosen");
    });
}

/// "spcbpt, 32000 paths (2), risbpt": the choices, with the number of seeds that made each if they
/// differ.
std::string chosenText(const Runs& runs) {
    std::map<std::string, int> counts;
    for (const RunResult* r : runs) {
        const nlohmann::json& chosen = r->report.at("chosen");
        std::string text = chosen.at("method");
        const auto& parameters = chosen.at("parameters");
        if (const auto paths = parameters.find("train.paths"); paths != parameters.end()) {
            text += ", " + paths->get<std::string>() + " paths";
        }
        ++counts[text];
    }
    std::vector<std::string> parts;
    for (const auto& [text, count] : counts) {
        parts.push_back(counts.size() == 1 ? text : text + " (" + std::to_string(count) + ")");
    }
    return joined(parts, "; ");
}

/// Among the methods other than auto, the one with the least median error at `end`, if any.
std::optional<std::size_t> bestOther(const Results& results, std::size_t scene, Measure measure,
                                     double end) {
    std::optional<std::size_t> best;
    double least = INFINITY;
    for (std::size_t m = 0; m < results.study.methods.size(); ++m) {
        const Runs runs = results.of(scene, m);
        if (choseForItself(runs)) continue;
        const auto error = spread(errorsAt(runs, measure, end, kAxis)).median;
        if (!error || !(*error < least)) continue;
        least = *error;
        best = m;
    }
    return best;
}

std::optional<double> regret(const RunResult& own, const RunResult& other, Measure measure,
                             double end) {
    const auto a = errorAt(own.curve.points, measure, end, kAxis);
    const auto b = errorAt(other.curve.points, measure, end, kAxis);
    if (!a || !b) return std::nullopt;
    const RunResult& better = *a < *b ? own : other;
    const auto time = timeToError(better.curve.points, measure, std::max(*a, *b), kAxis);
    if (!time) return 1.0;  // both end with the same error
    return &better == &own ? *time / end : end / *time;
}

std::string summary(const std::vector<double>& regrets) {
    double logs = 0.0;
    for (const double r : regrets) logs += std::log(r);
    const auto good = std::ranges::count_if(regrets, [](double r) { return r <= kAsGood; });
    return "Of " + std::to_string(regrets.size()) + " medians of regret the geometric mean is " +
           shortNumber(std::exp(logs / double(regrets.size()))) + ", the largest " +
           shortNumber(std::ranges::max(regrets)) + "; " + std::to_string(good) + " are at most " +
           shortNumber(kAsGood) + ".";
}

}  // namespace

Table choiceTable(const Results& results) {
    const Study& study = results.study;
    Table table;
    table.id = "choices";
    table.title = "What was chosen, and what it cost";
    table.columns = {"scene", "measure",        "method", "chose", "seconds of setup",
                     "until", "best other row", "regret"};
    std::vector<double> regrets;
    for (std::size_t s = 0; s < study.scenes.size(); ++s) {
        for (std::size_t m = 0; m < study.methods.size(); ++m) {
            const Runs own = results.of(s, m);
            if (!choseForItself(own)) continue;
            const double end = commonEnd(results.curvesOf(s), kAxis);
            std::vector<std::optional<double>> setups;
            for (const RunResult* r : own) setups.push_back(r->report.at("setup_seconds"));
            for (const std::string& name : study.measures) {
                const Measure measure = measureOf(name);
                const auto best = bestOther(results, s, measure, end);
                if (!best) continue;
                const Runs others = results.of(s, *best);
                std::vector<std::optional<double>> values;
                for (std::size_t i = 0; i < own.size(); ++i) {
                    values.push_back(regret(*own[i], *others[i], measure, end));
                }
                const Spread all = spread(values);
                if (all.median) regrets.push_back(*all.median);
                table.rows.push_back({study.scenes[s].name, name, study.methods[m].name,
                                      chosenText(own), spread(setups), shortNumber(end) + " s",
                                      study.methods[*best].name, all});
            }
        }
    }
    table.notes = {
        "Regret is the chooser's time over that of the best other row, both with setup and pilot, "
        "to the error that the worse of the two has where the shortest run of the scene ends. The "
        "best row is the one with the least median error there. Below 1 the chooser is faster."};
    if (!regrets.empty()) table.notes.push_back(summary(regrets));
    return table;
}

}  // namespace lacuna
