// What a command line says about the scene and how it is looked at: the same options for every tool
// that loads one, so that what is learned of a scene beforehand is learned of what is rendered.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/scene/description.h"
#include "libcore/tool/effect_switches.h"
#include "libcore/tool/tool.h"

namespace lacuna {

struct SceneOptions {
    CommonOptions common;
    std::string scene;
    /// The content of the .glb `scene`, where it lies in memory alone; null: it is a file.
    std::shared_ptr<const std::vector<std::uint8_t>> sceneBytes;

    std::string environment, environmentColourText;
    std::optional<double> environmentRotation, environmentScale;
    std::string unitsText;                 ///< --units
    std::vector<std::string> effectTexts;  ///< --effect
    double tolerance = 0.0;

    std::string camera;
    std::optional<double> aperture, focus;
    std::optional<std::int64_t> width, height;
    std::string scaleText, shiftText;
    std::optional<std::int64_t> maxDepth, rouletteDepth;

    // By checkSceneOptions.
    std::vector<EffectSwitch> effectSwitches;  ///< of effectTexts
    double scale = 1.0;                        ///< of the picture's sides, of scaleText
    std::optional<std::array<double, 2>> shift;
    std::optional<Rgb> environmentColour;
    LampUnits units = LampUnits::Radiometric;  ///< of unitsText
};

/// Declares --env, --env-colour, --env-rotate, --env-scale, --units, --effect and --tolerance. Both must
/// outlive the parsing.
void addSceneOptions(CLI::App& app, SceneOptions& options);
/// Declares --width, --height, --scale, --camera, --shift, --aperture, --focus, --max-depth and --rr-depth.
void addViewOptions(CLI::App& app, SceneOptions& options);

/// Parses the switches and checks every range that the scene has no say in. Throws UsageError, and
/// InputError for an environment of another format.
void checkSceneOptions(SceneOptions& options);

/// Throws UsageError for a picture without pixels or beyond kMaxImageSide, kMaxImagePixels.
void requireSaneFilm(std::int64_t width, std::int64_t height);

/// The options of addSceneOptions that were given, as a shell takes them: " --env sky.hdr", or
/// nothing.
std::string sceneArguments(const SceneOptions& options);
/// Likewise those of addViewOptions.
std::string viewArguments(const SceneOptions& options);

/// Throws UsageError unless low <= value <= high, if there is one.
void requireRange(const char* option, const std::optional<std::int64_t>& value, std::int64_t low,
                  std::int64_t high);
/// Likewise; `expected` says in words what is.
void requireReal(const char* option, const std::optional<double>& value, double low, double high,
                 const char* expected);

}  // namespace lacuna
