// What the command line of lacuna-render says, checked as far as it can be without the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcore/bidir/film.h"
#include "render/effect_switches.h"
#include "render/tool.h"

namespace lacuna {

/// `--replay x,y,i` or `--replay light:PATH,i`.
struct ReplayRequest {
    bool light = false;
    int x = 0, y = 0;        ///< pixel of the full image
    std::uint64_t path = 0;  ///< light subpath
    std::uint32_t iteration = 0;
};

struct RenderOptions {
    CommonOptions common;
    std::string commandLine;  ///< as a shell would take it again

    std::string scene, output, method;
    std::vector<std::string> assignments;  ///< --set
    std::optional<std::int64_t> width, height;
    std::optional<std::int64_t> iterations;
    std::string timeText, cropText, replayText;
    bool countSetup = false;
    std::optional<std::int64_t> maxDepth, rouletteDepth;
    std::optional<double> aperture, focus;
    std::string camera;
    std::string environment;
    std::optional<double> environmentRotation, environmentScale;
    std::string reference, log;
    bool prepare = false, techniques = false, verify = false;
    double tolerance = 0.0;
    double exposure = 0.0;
    bool listMethods = false, effects = false;
    std::string helpMethod;
    std::string displayServer, checkpoint;

    // Made from the texts above by checkOptions.
    std::optional<double> timeSeconds;
    std::optional<PixelRect> crop;
    std::optional<ReplayRequest> replay;
    std::vector<EffectSwitch> effectSwitches;  ///< taken out of `assignments`
};

/// Declares every option. Both must outlive the parsing.
void declareOptions(CLI::App& app, RenderOptions& options);

/// Parses the texts and checks every range that the scene has no say in. Throws UsageError, and
/// InputError for an environment of another format.
void checkOptions(RenderOptions& options);

/// Throws UsageError where the result and an input, or two results, would be the same file;
/// RunError where a result cannot be written. Leaves no file behind.
void checkOutputs(const RenderOptions& options);

/// "90s", "90", "10m", "1h" (decimals allowed) in seconds. Throws UsageError.
double parseDuration(const std::string& text);
/// "x0,x1,y0,y1", half open, not empty. Throws UsageError.
PixelRect parseCrop(const std::string& text);
/// Throws UsageError.
ReplayRequest parseReplay(const std::string& text);
/// Throws UsageError for a picture without pixels or beyond kMaxImageSide, kMaxImagePixels.
void requireSaneFilm(std::int64_t width, std::int64_t height);

/// The arguments joined, quoted where a shell needs it.
std::string commandLineText(int argc, const char* const* argv);

}  // namespace lacuna
