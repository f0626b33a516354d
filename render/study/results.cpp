#include "render/study/results.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace lacuna {

std::vector<const RunResult*> Results::of(std::size_t scene, std::size_t method) const {
    std::vector<const RunResult*> all;
    for (const std::uint64_t seed : study.seeds) {
        for (const RunResult& r : runs) {
            if (r.run.scene == scene && r.run.method == method && r.run.seed == seed) {
                all.push_back(&r);
            }
        }
    }
    return all;
}

std::string csvField(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

namespace {
std::string runColumns(const Results& results, const RunResult& r) {
    const StudyMethod& method = results.study.methods[r.run.method];
    return csvField(results.study.scenes[r.run.scene].name) + "," + csvField(method.name) + "," +
           method.method + "," + std::to_string(r.run.seed) + "," + r.run.id;
}
}  // namespace

std::vector<const Curve*> Results::curvesOf(std::size_t scene) const {
    std::vector<const Curve*> curves;
    for (const RunResult& r : runs) {
        if (r.run.scene == scene) curves.push_back(&r.curve);
    }
    return curves;
}

std::vector<std::optional<double>> errorsAt(std::span<const RunResult* const> runs, Measure measure,
                                            double x, Axis axis) {
    std::vector<std::optional<double>> values;
    for (const RunResult* r : runs) values.push_back(errorAt(r->curve.points, measure, x, axis));
    return values;
}

std::string rawCsv(const Results& results) {
    std::string text = "scene,name,method,seed,run," + results.runs.at(0).curve.header + "\n";
    for (const RunResult& r : results.runs) {
        for (const std::string& line : r.curve.lines) {
            text += runColumns(results, r) + "," + line + "\n";
        }
    }
    return text;
}

std::string runsCsv(const Results& results) {
    const char* const keys[] = {"iterations", "seconds",      "setup_seconds", "warmup_iterations",
                                "rays",       "peak_bytes",   "threads",       "stopped",
                                "scene_hash", "cache_hashes", "command_line"};
    std::string text = "scene,name,method,seed,run";
    for (const char* key : keys) text += std::string(",") + key;
    text += "\n";
    for (const RunResult& r : results.runs) {
        text += runColumns(results, r);
        for (const char* key : keys) {
            const nlohmann::json& value = r.report.at(key);
            text += ',';
            text += csvField(value.is_string() ? value.get<std::string>() : value.dump());
        }
        text += "\n";
    }
    return text;
}

}  // namespace lacuna
