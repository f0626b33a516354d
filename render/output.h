// The results of a render: the image with its layers and header, and the JSON.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/error_estimate.h"
#include "libcore/bidir/features.h"
#include "libcore/bidir/integrator.h"
#include "libcore/bidir/verify.h"
#include "libcore/image/error_metrics.h"
#include "libcore/methods/registry.h"
#include "libcore/tool/effects.h"
#include "render/choose/choice.h"
#include "render/technique_table.h"

namespace lacuna {

/// The content of header and JSON.
struct RenderReport {
    std::string commandLine;
    const MethodRow* method = nullptr;
    std::optional<RowChoice> choice;  ///< if `auto` chose the method
    Settings settings;
    std::uint64_t seed = 1;
    Sampling sampling = Sampling::Independent;
    int threads = 1;  ///< of rank 0
    int ranks = 1;
    std::uint64_t receivedBytes = 0;  ///< from other ranks
    int filmWidth = 0, filmHeight = 0;
    PixelRect crop;
    WalkLimits limits;
    GlassEffort glassEffort;
    std::uint64_t lightPaths = 0;

    std::uint64_t iterations = 0;
    BlockPlan blocks;
    std::uint64_t firstBlock = 0;
    bool techniques = false;
    std::vector<std::string> lightGroups;       ///< if they have layers
    std::map<std::string, std::string> layers;  ///< expressions by name
    std::vector<TechniqueCost> techniqueCosts;  ///< --techniques
    int warmupIterations = 0;                   ///< per block
    double seconds = 0.0;  ///< of warm-ups and iterations, without comparing, logging, saving
    double setupSeconds = 0.0;
    IterationStatistics statistics;
    std::map<std::string, double> phaseSeconds;
    std::string stopped;  ///< iterations, time, error, interrupt; empty: not yet
    ErrorEstimate estimate;
    FilmSum::MeanColour mean;
    std::optional<WeightVerifier::Result> verify;
    std::optional<ErrorMeasures> error;  ///< against --reference
    std::optional<double> exposure;      ///< stops of a .png

    std::string sceneHash;
    std::map<std::string, std::string> cacheHashes;
    double tolerance = 0.0;
    std::vector<Effect> effects;
    std::vector<std::string> warnings;
};

/// The method's parameters with their values.
nlohmann::json parametersJson(const MethodRow& row, const Settings& settings);

/// Sets the picture, its variance and its layers. `lightGroups`: names of groups if they have
/// layers.
void setPicture(LayeredImage& image, const FilmSum& sum, std::span<const std::string> lightGroups);

/// Adds the layers albedo, normal and position, and Z.
void setFeatures(LayeredImage& image, const FeatureLayers& features);

/// The picture with its header. `still`: layers that do not depend on iterations; may be null.
LayeredImage composeImage(const RenderReport& report, const FilmSum& sum,
                          const LayeredImage* still);

/// An array of three numbers. Those that are not finite become the text "inf" or "nan".
nlohmann::json numbersJson(const double (&values)[3]);

/// EXR has 32-bit integers. Larger ones become text.
Attribute integerAttribute(std::uint64_t value);

/// {"simulated": [names], "left_out": [names], "reasons": {name: text}}
nlohmann::json effectsJson(const std::vector<Effect>& effects);

/// The report with the keys that README.md, "--json", lists.
nlohmann::json reportJson(const RenderReport& report);

/// The same as indented text.
std::string reportText(const RenderReport& report);

/// Writes indented JSON atomically. Throws RunError.
void writeJson(const std::string& path, const nlohmann::json& json);

}  // namespace lacuna
