// The results of a study's runs, by scene, method and seed.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/study/curve.h"
#include "render/study/plan.h"
#include "render/study/reference.h"

namespace lacuna {

struct RunResult {
    PlannedRun run;
    Curve curve;
    nlohmann::json report;                  ///< lacuna-render's --json
    std::string image;                      ///< path
    std::vector<ErrorMeasures> cropErrors;  ///< of `image` inside each of the scene's crops
};

/// A render with a layer per technique (see planTechniques).
struct TechniqueResult {
    PlannedRun run;
    nlohmann::json report;  ///< lacuna-render's --json
    std::string image;      ///< path
};

struct Results {
    Study study;
    std::string machine;                      ///< see machineText
    std::string rendererHash;                 ///< of lacuna-render's files
    std::vector<SceneFacts> facts;            ///< by scene
    std::vector<Reference> references;        ///< by scene
    std::vector<RunResult> runs;              ///< in the order of the plan
    std::vector<TechniqueResult> techniques;  ///< likewise; empty if not requested

    /// The runs of one scene and method, in the order of study.seeds.
    std::vector<const RunResult*> of(std::size_t scene, std::size_t method) const;
    /// The curves of all runs of a scene.
    std::vector<const Curve*> curvesOf(std::size_t scene) const;
};

/// errorAt() of each run.
std::vector<std::optional<double>> errorsAt(std::span<const RunResult* const> runs, Measure measure,
                                            double x, Axis axis);
/// One row per run and checkpoint: scene, name, method, seed, run, then the curve's columns.
std::string rawCsv(const Results& results);
/// One row per run: its description and totals.
std::string runsCsv(const Results& results);
/// The text as a CSV field, quoted if necessary.
std::string csvField(const std::string& text);

}  // namespace lacuna
