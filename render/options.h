// The command line of lacuna-render, checked as far as possible without the scene.
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
    std::string commandLine;  ///< as text that can be given to a shell

    std::string output, method;
    bool inMemory = false;                 ///< the output is optional: the caller gets the picture
    std::vector<MethodRow> ownMethods;     ///< in addition to those of the registry
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
    bool allowBias = false;  ///< `auto` may choose methods that merge
    bool listMethods = false, effects = false;
    std::string helpMethod;
    std::string displayServerText, displayLayersText, writeEveryText;
    std::string checkpoint, checkpointEveryText, blocksText;
    std::optional<std::int64_t> blockIterations;

    // Parsed from the texts above by checkOptions.
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

/// Declares every option. Both arguments must outlive the parsing.
void declareOptions(CLI::App& app, RenderOptions& options);

/// Declares --half and --multi-part, also for lacuna-merge.
void addExrOptions(CLI::App& app, ExrStyle& style, const std::string& group);

/// Parses the texts and checks every range that does not depend on the scene. Throws UsageError,
/// and InputError for an environment of an unsupported format.
void checkOptions(RenderOptions& options);

/// The row of --method, also among options.ownMethods. Until `auto` has chosen, it is a stand-in
/// row with all techniques. Throws UsageError for an unknown name.
const MethodRow& namedRow(const RenderOptions& options);

/// Throws UsageError if a result and an input, or two results, are the same file; RunError if a
/// result cannot be written. Leaves no file behind.
void checkOutputs(const RenderOptions& options);

/// Seconds of "90s", "90", "10m" or "1h" (decimals allowed). Throws UsageError, which names
/// `option`.
double parseDuration(const std::string& option, const std::string& text);
/// Parses "A,B", half open and not empty. Throws UsageError.
BlockRange parseBlocks(const std::string& text);
/// Throws UsageError.
Sampling parseSampler(const std::string& text);
/// Parses "x0,x1,y0,y1", half open and not empty. Throws UsageError.
PixelRect parseCrop(const std::string& text);
/// Throws UsageError.
ReplayRequest parseReplay(const std::string& text);

}  // namespace lacuna
