// What the command line of lacuna-render says, checked as far as it can be without the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcore/bidir/film.h"
#include "libcore/bidir/path_layers.h"
#include "libcore/bidir/sampler.h"
#include "libcore/image/exr.h"
#include "libcore/image/tone.h"
#include "libcore/methods/registry.h"
#include "libcore/tool/scene_options.h"
#include "render/accuracy.h"
#include "render/layer_options.h"
#include "render/live/server_address.h"

namespace lacuna {

/// `--replay x,y,i` or `--replay light:PATH,i`.
struct ReplayRequest {
    bool light = false;
    int x = 0, y = 0;        ///< pixel of the full image
    std::uint64_t path = 0;  ///< light subpath
    std::uint32_t iteration = 0;
};

/// Blocks `begin` .. `end` - 1.
struct BlockRange {
    std::uint64_t begin = 0, end = 0;
};

struct RenderOptions : SceneOptions {
    std::string commandLine;  ///< as a shell would take it again

    std::string output, method;
    bool inMemory = false;                 ///< who has no output gets the picture itself
    std::vector<MethodRow> ownMethods;     ///< beside those of the registry
    std::vector<std::string> assignments;  ///< --set
    std::optional<std::int64_t> iterations;
    std::string timeText, cropText, replayText, samplerText;
    std::string exposureText = "auto", toneText = "filmic", sheet;
    std::optional<std::int64_t> pngBits;
    std::string untilText;
    bool countSetup = false, estimate = false;
    std::string reference, log;
    bool prepare = false, techniques = false, verify = false, denoise = false;
    bool lightGroups = false, lightNoise = false;
    std::vector<std::string> layerTexts;
    bool transparentBackground = false;
    std::string cryptomatteText;
    bool allowBias = false;  ///< `auto` may choose rows that merge
    bool listMethods = false, effects = false;
    std::string helpMethod;
    std::string displayServerText, displayLayersText, writeEveryText;
    std::string checkpoint, checkpointEveryText, blocksText;
    std::optional<std::int64_t> blockIterations;

    // Made from the texts above by checkOptions.
    std::vector<LayerExpression> layers;
    MatteTypes mattes;  ///< --cryptomatte
    std::optional<double> timeSeconds;
    std::optional<UntilRequest> until;
    Sampling sampling = Sampling::Independent;
    std::optional<PixelRect> crop;
    PngStyle png;
    ExrStyle exr;
    std::optional<ReplayRequest> replay;
    double checkpointSeconds = 60.0;
    std::optional<BlockRange> blocks;
    std::optional<ServerAddress> displayServer;
    std::vector<std::string> displayLayers;
    std::optional<double> writeEverySeconds;
};

/// Declares every option. Both must outlive the parsing.
void declareOptions(CLI::App& app, RenderOptions& options);

/// --half and --multi-part, of lacuna-merge as well.
void addExrOptions(CLI::App& app, ExrStyle& style, const std::string& group);

/// Parses the texts and checks every range that the scene has no say in. Throws UsageError, and
/// InputError for an environment of another format.
void checkOptions(RenderOptions& options);

/// The row of --method, or what stands for it until `auto` has chosen: a row with all techniques.
/// Throws UsageError for a name that no row has, those of options.ownMethods included.
const MethodRow& namedRow(const RenderOptions& options);

/// Throws UsageError where the result and an input, or two results, would be the same file;
/// RunError where a result cannot be written. Leaves no file behind.
void checkOutputs(const RenderOptions& options);

/// "90s", "90", "10m", "1h" (decimals allowed) in seconds. Throws UsageError that names `option`.
double parseDuration(const std::string& option, const std::string& text);
/// "A,B", half open, not empty. Throws UsageError.
BlockRange parseBlocks(const std::string& text);
/// Throws UsageError.
Sampling parseSampler(const std::string& text);
/// "x0,x1,y0,y1", half open, not empty. Throws UsageError.
PixelRect parseCrop(const std::string& text);
/// Throws UsageError.
ReplayRequest parseReplay(const std::string& text);

}  // namespace lacuna
