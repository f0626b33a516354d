#include "render/technique_table.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>

#include "libcore/bidir/technique_film.h"

namespace lacuna {
namespace {

using nlohmann::json;

double meanOf(std::span<const float> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

double phase(const IterationStatistics& statistics, const std::string& name) {
    const auto found = statistics.phaseSeconds.find(name);
    return found == statistics.phaseSeconds.end() ? 0.0 : found->second;
}

/// The order as text: "2", "3 and later".
std::string orderText(int order) {
    if (order == 0) return "";
    return std::to_string(order) + (order == TechniqueGroup::kOrders ? " and later" : "");
}

template <class... Values>
std::string line(const char* format, Values... values) {
    char text[128];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

}  // namespace

std::vector<TechniqueCost> techniqueCosts(const FilmSum& sum, const ErrorMeter& meter,
                                          const IterationStatistics& statistics, double threads,
                                          const ThreadPool* pool) {
    const auto& whole = sum.wholeMean;
    const double mean = (whole[0] + whole[1] + whole[2]) / 3.0;
    const TechniqueSeconds& seconds = statistics.techniqueSeconds;
    std::vector<TechniqueCost> costs;
    double variances = 0.0;
    for (std::size_t i = 0; i < TechniqueGroup::kCount; ++i) {
        const TechniqueGroup group = TechniqueGroup::at(i);
        const auto weighted = sum.layers.find("weighted." + group.name());
        if (weighted == sum.layers.end() && seconds[i] == 0.0) continue;
        TechniqueCost cost{.name = group.kindName(), .seconds = seconds[i]};
        if (group.kind != TechniqueKind::Splats) cost.order = group.order;
        if (weighted != sum.layers.end()) {
            cost.energy = mean != 0.0 ? meanOf(weighted->second) / mean : 0.0;
            cost.variance = meter.overSquare(
                sum, techniqueVariance(sum.layers, group.name(), sum.samples), pool);
        }
        variances += cost.variance;
        costs.push_back(cost);
    }
    for (TechniqueCost& cost : costs) cost.share = variances > 0.0 ? cost.variance / variances : 0;

    const auto add = [&](const char* name, double ofThreads) {
        if (ofThreads <= 0.0) return;
        costs.push_back({.name = name, .technique = false, .seconds = ofThreads});
    };
    add("eye walks", seconds[kEyeWalks]);
    add("light walks", seconds[kLightWalks]);
    add("preparation", threads * (phase(statistics, "prepare") + phase(statistics, "observe")));
    add("rest", threads * (phase(statistics, "light paths") + phase(statistics, "eye paths")) -
                    std::accumulate(seconds.begin(), seconds.end(), 0.0));
    return costs;
}

std::string techniqueTable(const std::vector<TechniqueCost>& costs) {
    double seconds = 0.0;
    for (const TechniqueCost& cost : costs) seconds += cost.seconds;
    std::string text =
        line("%-12s %-12s %7s %9s %7s\n", "technique", "eye vertex", "energy", "variance", "time");
    const auto percent = [](double share) { return line("%.1f %%", 100.0 * share); };
    for (const TechniqueCost& cost : costs) {
        const std::string time = percent(seconds > 0.0 ? cost.seconds / seconds : 0.0);
        text += line("%-12s %-12s %7s %9s %7s\n", cost.name.c_str(), orderText(cost.order).c_str(),
                     cost.technique ? percent(cost.energy).c_str() : "",
                     cost.technique ? percent(cost.share).c_str() : "", time.c_str());
    }
    return text;
}

json techniqueCostsJson(const std::vector<TechniqueCost>& costs) {
    json list = json::array();
    for (const TechniqueCost& cost : costs) {
        json row{{"technique", cost.name}, {"seconds", cost.seconds}};
        if (cost.order > 0) row["order"] = cost.order;
        if (cost.technique) {
            row["energy"] = cost.energy;
            row["variance"] = cost.variance;
            row["variance_share"] = cost.share;
        }
        list.push_back(std::move(row));
    }
    return list;
}

}  // namespace lacuna
