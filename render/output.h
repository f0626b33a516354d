// What a render leaves behind: the image with its layers and header, and the JSON.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libcore/bidir/features.h"
#include "libcore/bidir/integrator.h"
#include "libcore/bidir/verify.h"
#include "libcore/image/error_metrics.h"
#include "libcore/methods/registry.h"
#include "libcore/tool/effects.h"

namespace lacuna {

/// Everything that header and JSON say.
struct RenderReport {
    std::string commandLine;
    const MethodRow* method = nullptr;
    Settings settings;
    std::uint64_t seed = 1;
    int threads = 1;
    int filmWidth = 0, filmHeight = 0;
    PixelRect crop;
    WalkLimits limits;
    std::uint64_t lightPaths = 0;

    std::uint64_t iterations = 0;
    int warmupIterations = 0;
    double seconds = 0.0;  ///< warm-up and iterations; no comparing, logging, saving
    double setupSeconds = 0.0;
    IterationStatistics statistics;
    std::map<std::string, double> phaseSeconds;
    std::string stopped;  ///< iterations, time, interrupt
    Film::MeanColour mean;
    std::optional<WeightVerifier::Result> verify;
    std::optional<ErrorMeasures> error;  ///< against --reference

    std::string sceneHash;
    std::map<std::string, std::string> cacheHashes;
    double tolerance = 0.0;
    std::vector<Effect> effects;
    std::vector<std::string> warnings;
};

/// The method's parameters with their values.
nlohmann::json parametersJson(const MethodRow& row, const Settings& settings);

/// The picture with variance, features (may be null), technique layers (may be null) and header.
LayeredImage composeImage(const RenderReport& report, const Film& film,
                          const FeatureLayers* features, const TechniqueFilm* techniques);

/// {"simulated": [names], "left_out": [names], "reasons": {name: text}}
nlohmann::json effectsJson(const std::vector<Effect>& effects);

/// The keys that README.md, "--json" lists.
nlohmann::json reportJson(const RenderReport& report);

/// Atomically, as text that people can read. Throws RunError.
void writeJson(const std::string& path, const nlohmann::json& json);

}  // namespace lacuna
