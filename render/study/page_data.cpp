#include "render/study/page_data.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libcore/image/error_map.h"
#include "render/study/band.h"

namespace lacuna {
namespace {

using nlohmann::json;

/// The disjoint phases of an iteration by lacuna-render's names (render/README.md, "--log").
constexpr const char* kPhases[] = {"warm-up", "light paths", "prepare", "eye paths", "observe"};

std::vector<const Curve*> curvesOf(const Results& results, std::size_t scene, std::size_t method) {
    std::vector<const Curve*> curves;
    for (const RunResult* r : results.of(scene, method)) curves.push_back(&r->curve);
    return curves;
}

json bandJson(std::span<const Curve* const> curves, Measure measure, Axis axis) {
    json points = json::array();
    for (const BandPoint& p : band(curves, measure, axis)) {
        points.push_back({p.x, p.median, p.low, p.high});
    }
    return points;
}

json ownErrorJson(const Reference& reference) {
    if (!reference.ownError) return nullptr;
    const ErrorMeasures& e = *reference.ownError;
    return {{"mae", e.mae}, {"rmse", e.rmse}, {"mape", e.mape}, {"relmse", e.relmse}};
}

json sceneJson(const Results& results, std::size_t s) {
    const StudyScene& scene = results.study.scenes[s];
    const SceneFacts& facts = results.facts[s];
    const Reference& reference = results.references[s];
    return {{"name", scene.name},
            {"file", scene.file},
            {"hash", facts.hash},
            {"width", facts.crop.width()},
            {"height", facts.crop.height()},
            {"max_depth", facts.maxDepth},
            {"bounds", scene.bounds},
            {"reference",
             {{"path", reference.path},
              {"hash", reference.hash},
              {"origin", reference.origin},
              {"own_error", ownErrorJson(reference)},
              {"margins",
               {{"mae", referenceMargin(Measure::Mae)},
                {"rmse", referenceMargin(Measure::Rmse)},
                {"mape", referenceMargin(Measure::Mape)},
                {"relmse", referenceMargin(Measure::Relmse)}}}}}};
}

json methodJson(const StudyMethod& method) {
    return {{"name", method.name},
            {"method", method.method},
            {"set", method.assignments},
            {"options", method.options}};
}

/// Costs as means over seeds, so that parts add up to totals.
json costJson(const Results& results, std::size_t s, std::size_t m) {
    const std::vector<const RunResult*> runs = results.of(s, m);
    const double share = 1.0 / double(runs.size());
    std::map<std::string, double> phases, rays;
    double memory = 0.0;
    for (const RunResult* run : runs) {
        const json& report = run->report;
        double rest = report.at("seconds");
        phases["setup"] += share * report.at("setup_seconds").get<double>();
        for (const char* name : kPhases) {
            const double seconds = report.at("phases").value(name, 0.0);
            phases[name] += share * seconds;
            rest -= seconds;
        }
        phases["other"] += share * std::max(rest, 0.0);
        for (const auto& [kind, count] : report.at("rays_by_kind").items()) {
            rays[kind] += share * count.get<double>();
        }
        memory += share * report.at("peak_bytes").get<double>();
    }
    return {{"phases", phases}, {"rays", rays}, {"peak_bytes", memory}};
}

/// Median, low and high; null for values that were not reached.
json spreadJson(const Spread& s) {
    json object = json::object();
    for (const auto& [key, value] :
         {std::pair{"median", s.median}, std::pair{"low", s.low}, std::pair{"high", s.high}}) {
        object[key] = value ? json(*value) : json(nullptr);
    }
    return object;
}

/// The results of a knob by value: the error at equal iterations, in which setup does not count;
/// and, with setup, the error at equal time and the time to every bound that any value reaches.
json knobJson(const Results& results, std::size_t s, const std::string& measureName,
              const std::string& group) {
    const Study& study = results.study;
    const Measure measure = measureOf(measureName);
    std::vector<std::vector<const Curve*>> curves;  // by value
    std::vector<const Curve*> all;
    json values = json::array();
    std::string knob;
    for (std::size_t m = 0; m < study.methods.size(); ++m) {
        const StudyMethod& method = study.methods[m];
        if (method.knob.empty() || method.knobGroup != group) continue;
        knob = method.knob;
        values.push_back(method.knobValue);
        curves.push_back(curvesOf(results, s, m));
        all.insert(all.end(), curves.back().begin(), curves.back().end());
    }
    const auto byValue = [&](const auto& read) {
        json points = json::array();
        for (const std::vector<const Curve*>& seeds : curves) {
            std::vector<std::optional<double>> numbers;
            for (const Curve* curve : seeds) numbers.push_back(read(curve->points));
            points.push_back(spreadJson(spread(numbers)));
        }
        return points;
    };
    const Axis axis = Axis::SecondsWithSetup;
    const double end = commonEnd(all, axis);
    const json errors = byValue([&](const auto& p) { return errorAt(p, measure, end, axis); });
    const double iterations = commonEnd(all, Axis::Iterations);
    const json iterationErrors =
        byValue([&](const auto& p) { return errorAt(p, measure, iterations, Axis::Iterations); });
    json times = json::array();
    const auto bounds = study.scenes[s].bounds.find(measureName);
    if (bounds != study.scenes[s].bounds.end()) {
        for (const double bound : bounds->second) {
            json points =
                byValue([&](const auto& p) { return timeToError(p, measure, bound, axis); });
            const bool reached = std::any_of(points.begin(), points.end(), [](const json& p) {
                return !p.at("median").is_null();
            });
            if (reached) times.push_back({{"bound", bound}, {"points", std::move(points)}});
        }
    }
    return {{"group", group},
            {"knob", knob},
            {"values", values},
            {"iterations", iterations},
            {"iteration_errors", iterationErrors},
            {"seconds", end},
            {"errors", errors},
            {"times", times}};
}

std::vector<std::string> knobGroups(const Study& study) {
    std::vector<std::string> groups;
    for (const StudyMethod& m : study.methods) {
        if (!m.knob.empty() && std::count(groups.begin(), groups.end(), m.knobGroup) == 0) {
            groups.push_back(m.knobGroup);
        }
    }
    return groups;
}

json tableJson(const Table& table) {
    json rows = json::array();
    for (const auto& row : table.rows) {
        json cells = json::array();
        for (const Table::Cell& cell : row) cells.push_back(cellText(cell));
        rows.push_back(std::move(cells));
    }
    return {{"id", table.id},
            {"title", table.title},
            {"columns", table.columns},
            {"rows", rows},
            {"notes", table.notes}};
}

json runJson(const RunResult& r) {
    json object{{"scene", r.run.scene},
                {"method", r.run.method},
                {"seed", r.run.seed},
                {"id", r.run.id},
                {"error", r.report.value("error", json::object())}};
    for (const char* key : {"iterations", "seconds", "setup_seconds", "rays", "peak_bytes",
                            "threads", "stopped", "scene_hash", "cache_hashes", "command_line",
                            "parameters", "effects", "invalid_samples", "warnings"}) {
        object[key] = r.report.at(key);
    }
    return object;
}

}  // namespace

json pageData(const Results& results, const std::vector<Table>& tables) {
    const Study& study = results.study;
    json scenes = json::array(), methods = json::array(), runs = json::array();
    json bands = json::array(), costs = json::array(), knobs = json::array();
    for (const StudyMethod& method : study.methods) methods.push_back(methodJson(method));
    for (const RunResult& run : results.runs) runs.push_back(runJson(run));
    for (std::size_t s = 0; s < study.scenes.size(); ++s) {
        scenes.push_back(sceneJson(results, s));
        json sceneBands = json::array(), sceneCosts = json::array();
        for (std::size_t m = 0; m < study.methods.size(); ++m) {
            const std::vector<const Curve*> curves = curvesOf(results, s, m);
            json byMeasure = json::object();
            for (const std::string& name : study.measures) {
                const Measure measure = measureOf(name);
                byMeasure[name] = {
                    {"seconds", bandJson(curves, measure, Axis::Seconds)},
                    {"seconds_with_setup", bandJson(curves, measure, Axis::SecondsWithSetup)},
                    {"iterations", bandJson(curves, measure, Axis::Iterations)}};
            }
            sceneBands.push_back(std::move(byMeasure));
            sceneCosts.push_back(costJson(results, s, m));
        }
        bands.push_back(std::move(sceneBands));
        costs.push_back(std::move(sceneCosts));
        json byMeasure = json::object();
        for (const std::string& name : study.measures) {
            json all = json::array();
            for (const std::string& group : knobGroups(study)) {
                all.push_back(knobJson(results, s, name, group));
            }
            byMeasure[name] = std::move(all);
        }
        knobs.push_back(std::move(byMeasure));
    }
    json tablesJson = json::array(), colours = json::array();
    for (const Table& table : tables) tablesJson.push_back(tableJson(table));
    constexpr int kColours = 256;
    for (int i = 0; i < kColours; ++i) {
        const double t = i / double(kColours - 1);
        colours.push_back(errorColour(kErrorMapLow * std::pow(kErrorMapHigh / kErrorMapLow, t)));
    }
    return {{"title", study.title},
            {"about", study.about},
            {"file", study.file},
            {"machine", results.machine},
            {"version", LACUNA_VERSION},
            {"renderer_hash", results.rendererHash},
            {"seeds", study.seeds},
            {"baseline", study.baseline},
            {"measures", study.measures},
            {"scenes", scenes},
            {"methods", methods},
            {"bands", bands},
            {"costs", costs},
            {"knobs", knobs},
            {"tables", tablesJson},
            {"runs", runs},
            {"error_map", {{"low", kErrorMapLow}, {"high", kErrorMapHigh}, {"colours", colours}}}};
}

}  // namespace lacuna
