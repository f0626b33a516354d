// Command-line options of the scene and the view. All tools that load a scene have the same
// options, so that preprocessing uses the same scene as rendering.
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
    /// The content of the .glb `scene` if it is only in memory; null: it is a file.
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

    // Set by checkSceneOptions.
    std::vector<EffectSwitch> effectSwitches;  ///< from effectTexts
    double scale = 1.0;                        ///< factor of the picture's sides, from scaleText
    std::optional<std::array<double, 2>> shift;
    std::optional<Rgb> environmentColour;
    LampUnits units = LampUnits::Radiometric;  ///< from unitsText
};

/// Declares --env, --env-colour, --env-rotate, --env-scale, --units, --effect and --tolerance. Both must
/// outlive the parsing.
void addSceneOptions(CLI::App& app, SceneOptions& options);
/// Declares --width, --height, --scale, --camera, --shift, --aperture, --focus, --max-depth and --rr-depth.
void addViewOptions(CLI::App& app, SceneOptions& options);

/// Parses texts and checks every range that does not depend on the scene. Throws UsageError, and
/// InputError for an environment of an unsupported format.
void checkSceneOptions(SceneOptions& options);

/// Throws UsageError for a picture without pixels or beyond kMaxImageSide, kMaxImagePixels.
void requireSaneFilm(std::int64_t width, std::int64_t height);

/// The options of addSceneOptions that were given, as text for a shell: " --env sky.hdr", or
/// nothing.
std::string sceneArguments(const SceneOptions& options);
/// The same for the options of addViewOptions.
std::string viewArguments(const SceneOptions& options);

/// Throws UsageError if there is a value and it is not in [low, high].
void requireRange(const char* option, const std::optional<std::int64_t>& value, std::int64_t low,
                  std::int64_t high);
/// Likewise; `expected` describes the range in words.
void requireReal(const char* option, const std::optional<double>& value, double low, double high,
                 const char* expected);

}  // namespace lacuna
