#include "render/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/number_text.h"
#include "libcore/base/own_files.h"
#include "libcore/base/text_list.h"
#include "libcore/image/image_io.h"
#include "render/choose/choice.h"
#include "render/layer_options.h"
#include "render/live/layer_names.h"

namespace lacuna {
namespace {
constexpr std::uint64_t kMaxIterations = 1'000'000'000;
}

void declareOptions(CLI::App& app, RenderOptions& o) {
    app.add_option("SCENE", o.scene, "Scene: .glb or .gltf")->type_name("SCENE.glb");
    app.add_option("-o,--output", o.output, "Image: .exr (layers, statistics), .png or .pfm")
        ->type_name("FILE");
    app.add_option(
           "--method", o.method,
           "Method (default: auto, which chooses one for the scene); --list-methods lists them")
        ->type_name("NAME")
        ->take_last();
    app.add_flag("--list-methods", o.listMethods, "Print all methods, a line each");
    app.add_option("--help-method", o.helpMethod, "Print a method's parameters for --set")
        ->type_name("NAME");
    app.add_flag("--allow-bias", o.allowBias,
                 "auto may also choose methods that merge, which are consistent, not unbiased");
    app.add_option("--set", o.assignments, "Set a parameter of the method; may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);

    addSceneOptions(app, o);
    addViewOptions(app, o);
    const std::string picture = "Picture and camera";
    app.add_option("--crop", o.cropText, "Render these pixels of the picture only (half open)")
        ->type_name("x0,x1,y0,y1")
        ->group(picture);
    app.add_option(
           "--exposure", o.exposureText,
           "Stops, or auto, which maps the log-average luminance to mid-grey; for .png only "
           "(default: auto)")
        ->type_name("E|auto")
        ->group(picture);
    app.add_option("--tone", o.toneText,
                   "What is too bright for a screen fades to white (filmic) or is cut off "
                   "(standard); for .png only (default: filmic)")
        ->type_name("standard|filmic")
        ->group(picture);
    app.add_option("--png-bits", o.pngBits, "8 or 16 bits per channel; for .png only (default: 8)")
        ->type_name("N")
        ->group(picture);
    app.add_flag("--light-groups", o.lightGroups,
                 "A layer of the .exr for each group of lights; the layers add up to the picture")
        ->group(picture);
    app.add_flag("--light-noise", o.lightNoise,
                 "--light-groups, and the noise of every mixture of the groups, for lacuna-relight")
        ->group(picture);
    app.add_option("--layer", o.layerTexts,
                   "A layer of the paths that a light path expression matches, in OSL's notation "
                   "(C<RD>L, C.*<TS>.*L); may be repeated")
        ->type_name("NAME=EXPRESSION")
        ->allow_extra_args(false)
        ->group(picture);
    app.add_flag("--transparent-background", o.transparentBackground,
                 "Leave out the environment where the camera sees it; A (alpha) of the .exr and "
                 ".png is the share of a pixel that shows anything else")
        ->group(picture);
    app.add_option("--cryptomatte", o.cryptomatteText,
                   "Layers of the .exr from which mattes are cut by name: object, material or "
                   "object,material")
        ->type_name("TYPES")
        ->group(picture);
    addExrOptions(app, o.exr, picture);
    app.add_option("--sheet", o.sheet,
                   "Also write all layers of the .exr as a page of small pictures")
        ->type_name("FILE.png")
        ->group(picture);

    const std::string effort = "Effort";
    app.add_option("--iterations,--samples,--spp", o.iterations,
                   "Number of iterations, each with one eye path per pixel (default: 64; unlimited "
                   "with --time, --until)")
        ->type_name("N")
        ->group(effort);
    app.add_option("--time", o.timeText,
                   "Limit of the time from the first iteration on: 90s (or 90), 10m, 1h")
        ->type_name("T")
        ->group(effort);
    app.add_option(
           "--until", o.untilText,
           "Render until the error, estimated without a reference, is below E: mape, relmse, rmse")
        ->type_name("MEASURE=E")
        ->group(effort);
    app.add_flag("--estimate", o.estimate,
                 "Render for some seconds and print what accuracy costs; writes no image")
        ->group(effort);
    app.add_option("--sampler", o.samplerText,
                   "Random numbers: sobol (even over iterations) or independent (default: the "
                   "method's; auto takes sobol)")
        ->type_name("NAME")
        ->take_last()
        ->group(effort);
    app.add_flag("--count-setup", o.countSetup,
                 "Count all before the first iteration in --time too")
        ->group(effort);
    app.add_flag("--prepare", o.prepare, "Build missing or stale caches first")->group(effort);

    const std::string pieces = "Long renders";
    app.add_option("--checkpoint", o.checkpoint,
                   "Go on from FILE if it is there, save to it now and then and at an interrupt")
        ->type_name("FILE")
        ->group(pieces);
    app.add_option("--checkpoint-every", o.checkpointEveryText, "Time between saves (default: 60s)")
        ->type_name("T")
        ->group(pieces);
    app.add_option("--blocks", o.blocksText,
                   "Render only blocks A .. B-1 of the picture, as a part for lacuna-merge")
        ->type_name("A,B")
        ->group(pieces);
    app.add_option("--block-iterations", o.blockIterations,
                   "Iterations of a block, with each of which methods begin to learn anew "
                   "(default: 64; 16 where methods learn; 8 where iterations share light paths)")
        ->type_name("N")
        ->group(pieces);

    const std::string live = "While it renders";
    app.add_option("--display-server", o.displayServerText,
                   "Show the picture in tev while it is rendered (default port: 14158)")
        ->type_name("H:P")
        ->group(live);
    app.add_option("--display-layers", o.displayLayersText,
                   "Show these layers of the .exr as well, by name: variance,albedo")
        ->type_name("NAMES")
        ->group(live);
    app.add_option("--write-every", o.writeEveryText, "Write the image anew every so often: 30s")
        ->type_name("T")
        ->group(live);

    const std::string check = "Measuring and checking";
    app.add_option("--reference", o.reference, "Image to compare with: .exr, .hdr, .pfm, .png")
        ->type_name("FILE")
        ->group(check);
    app.add_option("--log", o.log, "Write error and rays against time, a row per iteration at most")
        ->type_name("CURVE.csv")
        ->group(check);
    app.add_flag(
           "--techniques", o.techniques,
           "Print what each technique (s, t) adds, its noise and its time; with layers in the .exr")
        ->group(check);
    app.add_flag("--verify", o.verify, "Recompute every weight by full products and compare")
        ->group(check);
    app.add_option("--replay", o.replayText, "Run one sample alone and print its path")
        ->type_name("x,y,i|light:PATH,i")
        ->group(check);
    app.add_flag("--effects", o.effects, "Print the effects that the scene needs; renders nothing")
        ->group(check);
    addCommonOptions(app, o.common);
    app.add_flag("--denoise", o.denoise)->group("");  // hidden; its error suggests an alternative
    app.footer(
        "Writes the image, and prints what it wrote. An interrupt (Ctrl-C) saves what there is;\n"
        "a second one exits at once. --width or --height alone keeps the shape of the default\n"
        "picture: that of extras.lacuna if it names both sides, else the camera's.\n"
        "An .exr has R G B, albedo, normal, Z (distance along the viewing axis, 0 where nothing\n"
        "is hit), position, variance (of the mean) and the layers that you ask for. Its header\n"
        "says how it was made. With --crop it has the size of the crop, and `crop` in the header\n"
        "says where that is.\n"
        "--layer: C camera, R reflected, T transmitted, L any light, O a mesh that emits, B the\n"
        "environment; D diffuse, G glossy, S mirror or smooth glass, as <RD>, <TS>, or alone; a\n"
        "third place for names: <L.'lamp'>, <RD'floor'>. . [] [^] | * + ? {n,m} () as usual. s,\n"
        "straight, matches nothing: what alpha lets pass is no event.\n"
        "mpirun -n P lacuna-render ... makes the same picture with P processes.\n"
        "Examples:\n"
        "  lacuna-render door.glb -o door.png --time 10s\n"
        "  lacuna-render door.glb -o door.exr --method spcbpt --prepare --time 1m\n"
        "  lacuna-render door.glb -o door.exr --until mape=0.05 --checkpoint door.checkpoint\n"
        "  lacuna-render door.glb --effects\n"
        "Exit codes: 0 done, 1 failed while running, 2 usage, 3 the scene or an image cannot be\n"
        "used, 130 interrupted.");
}

namespace {

/// Parses all of `text` as a number of type T.
template <class T>
bool parseNumber(std::string_view text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size();
}

/// The first option given for layers beyond those of every .exr; null: none.
const char* layerOption(const RenderOptions& o) {
    if (o.techniques) return "--techniques";
    if (o.lightNoise) return "--light-noise";
    if (o.lightGroups) return "--light-groups";
    if (o.mattes.any()) return "--cryptomatte";
    return o.layers.empty() ? nullptr : "--layer";
}

/// The option given about the format of an .exr; null: none.
const char* exrOption(const RenderOptions& o) {
    return o.exr.half ? "--half" : o.exr.multiPart ? "--multi-part" : nullptr;
}

/// Checks --estimate, which writes no image, and --until, which needs the whole one.
void checkAccuracy(const RenderOptions& o) {
    if (o.until && (o.blocks || o.estimate)) {
        throw UsageError("--until: expected a whole picture, found " +
                         std::string(o.blocks ? "--blocks" : "--estimate") +
                         "; leave one of them out");
    }
    const char* const other = o.blocks                ? "--blocks"
                              : !o.checkpoint.empty() ? "--checkpoint"
                              : o.replay              ? "--replay"
                              : o.verify              ? "--verify"
                              : layerOption(o)        ? layerOption(o)
                              : !o.log.empty()        ? "--log"
                              : !o.reference.empty()  ? "--reference"
                              : o.displayServer       ? "--display-server"
                              : o.writeEverySeconds   ? "--write-every"
                              : !o.sheet.empty()      ? "--sheet"
                                                      : nullptr;
    if (o.estimate && other) {
        throw UsageError("--estimate: expected a render that writes no image, found " +
                         std::string(other) + "; leave one of them out");
    }
}

/// Rejects options of long renders that exclude each other.
void checkPieces(const RenderOptions& o) {
    const bool pieces = o.blocks || !o.checkpoint.empty();
    if (!o.checkpointEveryText.empty() && o.checkpoint.empty()) {
        throw UsageError(
            "--checkpoint-every: expected together with --checkpoint; add --checkpoint FILE or "
            "leave it out");
    }
    if (o.verify && pieces) {
        throw UsageError("--verify: expected a render in one go, found " +
                         std::string(o.blocks ? "--blocks" : "--checkpoint") +
                         "; leave one of them out");
    }
    if (o.blocks && o.timeSeconds) {
        throw UsageError(
            "--blocks: expected a number of iterations, found --time; leave one of them out");
    }
    if (o.blocks && !o.output.empty() && endingOf(o.output) != ".exr") {
        throw UsageError("--blocks: expected an .exr to hold the part, found '" + o.output + "'");
    }
    if (const char* const style = exrOption(o); o.blocks && style) {
        throw UsageError(std::string(style) +
                         ": expected a whole picture, found --blocks; give it "
                         "to lacuna-merge");
    }
}

/// Sets the method to `auto` if none is named, and checks options that exclude it.
void checkMethod(RenderOptions& o) {
    if (o.method.empty()) o.method = kAuto;
    if (o.method != kAuto) return;
    const std::string byName = "; name a method (the picture's header says which was chosen)";
    if (!o.assignments.empty()) {
        throw UsageError("--set: expected the method that the parameter belongs to, found " +
                         std::string("--method auto") + byName);
    }
    if (o.replay) {
        throw UsageError("--replay: expected the method of the picture, found --method auto" +
                         byName);
    }
}

/// Options of the conversion to .png and of the sheet of layers.
void parsePng(RenderOptions& o) {
    o.png.exposure = parseExposure("--exposure", o.exposureText);
    o.png.tone = parseTone("--tone", o.toneText);
    o.png.bits = int(o.pngBits.value_or(8));
    if (o.png.bits != 8 && o.png.bits != 16) {
        throw UsageError("--png-bits: expected 8 or 16, found " + std::to_string(*o.pngBits));
    }
    if (!o.sheet.empty() && endingOf(o.sheet) != ".png") {
        throw UsageError("--sheet: expected a .png, found '" + o.sheet + "'; choose another name");
    }
}

/// The default output is NAME.png beside the scene. An existing file that this program has not
/// written is not replaced: it may be a texture.
void nameOutput(RenderOptions& o) {
    o.output = std::filesystem::path(o.scene).replace_extension(".png");
    std::error_code ignored;
    if (std::filesystem::exists(o.output, ignored) && !isOurPng(o.output)) {
        throw UsageError("-o: expected the image to write, found none, and " + o.output +
                         " exists and was not written by Lacuna; add -o FILE");
    }
}

/// Options of the live display.
void parseLive(RenderOptions& o) {
    if (!o.displayServerText.empty()) {
        o.displayServer = parseServerAddress("--display-server", o.displayServerText);
    }
    if (!o.displayLayersText.empty()) {
        o.displayLayers = parseLayers("--display-layers", o.displayLayersText);
        if (!o.displayServer) {
            throw UsageError(
                "--display-layers: expected together with --display-server; add --display-server "
                "localhost:14158 or leave it out");
        }
    }
    if (!o.writeEveryText.empty()) {
        if (o.inMemory && o.output.empty()) {
            throw UsageError("--write-every: expected an output to write, found none; name one");
        }
        o.writeEverySeconds = parseDuration("--write-every", o.writeEveryText);
    }
}

}  // namespace

double parseDuration(const std::string& option, const std::string& text) {
    const char unit = text.empty() ? '\0' : text.back();
    const double factor = unit == 'm' ? 60.0 : unit == 'h' ? 3600.0 : 1.0;
    std::string_view number = text;
    if (unit == 's' || unit == 'm' || unit == 'h') number.remove_suffix(1);
    double value = 0.0;
    if (!parseNumber(number, value) || !(value > 0.0) || !std::isfinite(value * factor)) {
        throw UsageError(option + ": expected a time above 0 such as 90s, 90, 10m or 1h, found '" +
                         text + "'");
    }
    return value * factor;
}

PixelRect parseCrop(const std::string& text) {
    const std::vector<std::string_view> parts = splitAtCommas(text);
    PixelRect r;
    if (parts.size() != 4 || !parseNumber(parts[0], r.x0) || !parseNumber(parts[1], r.x1) ||
        !parseNumber(parts[2], r.y0) || !parseNumber(parts[3], r.y1) || r.x0 < 0 || r.y0 < 0 ||
        r.x1 <= r.x0 || r.y1 <= r.y0) {
        throw UsageError("--crop: expected pixels x0,x1,y0,y1 with x0 < x1 and y0 < y1, found '" +
                         text + "'");
    }
    return r;
}

Sampling parseSampler(const std::string& text) {
    for (const Sampling sampling : {Sampling::Sobol, Sampling::Independent}) {
        if (text == nameOf(sampling)) return sampling;
    }
    throw UsageError("--sampler: expected sobol or independent, found '" + text + "'");
}

BlockRange parseBlocks(const std::string& text) {
    const std::vector<std::string_view> parts = splitAtCommas(text);
    BlockRange r;
    if (parts.size() != 2 || !parseNumber(parts[0], r.begin) || !parseNumber(parts[1], r.end) ||
        r.end <= r.begin || r.end > kMaxIterations) {
        throw UsageError("--blocks: expected A,B with A < B (blocks A to B - 1), found '" + text +
                         "'");
    }
    return r;
}

ReplayRequest parseReplay(const std::string& text) {
    constexpr std::string_view kLight = "light:";
    ReplayRequest r;
    std::string_view rest = text;
    r.light = rest.substr(0, kLight.size()) == kLight;
    if (r.light) rest.remove_prefix(kLight.size());
    const std::vector<std::string_view> parts = splitAtCommas(rest);
    const bool parsed = r.light ? parts.size() == 2 && parseNumber(parts[0], r.path)
                                : parts.size() == 3 && parseNumber(parts[0], r.x) &&
                                      parseNumber(parts[1], r.y) && r.x >= 0 && r.y >= 0;
    if (!parsed || !parseNumber(parts.back(), r.iteration)) {
        throw UsageError("--replay: expected x,y,iteration or light:PATH,iteration, found '" +
                         text + "'");
    }
    return r;
}

void checkOptions(RenderOptions& o) {
    checkSceneOptions(o);
    if (o.denoise) {
        throw UsageError(
            "--denoise: expected an option of Lacuna, found a task for another program; write an "
            ".exr, and give its layers R G B, albedo and normal to Open Image Denoise: python3 -m "
            "lacuna.denoise IN.exr OUT.exr");
    }
    for (const std::string& text : o.assignments) {
        if (!text.starts_with("effects.")) continue;
        throw UsageError("--set " + text +
                         ": effects have an option of their own; write --effect " +
                         text.substr(text.find('.') + 1));
    }
    requireRange("--iterations", o.iterations, 1, std::int64_t(kMaxIterations));
    requireRange("--block-iterations", o.blockIterations, 1, std::int64_t(kMaxIterations));
    parsePng(o);
    if (!o.timeText.empty()) o.timeSeconds = parseDuration("--time", o.timeText);
    if (!o.untilText.empty()) o.until = parseUntil(o.untilText);
    if (!o.blocksText.empty()) o.blocks = parseBlocks(o.blocksText);
    if (!o.samplerText.empty()) o.sampling = parseSampler(o.samplerText);
    if (!o.checkpointEveryText.empty()) {
        o.checkpointSeconds = parseDuration("--checkpoint-every", o.checkpointEveryText);
    }
    parseLive(o);
    o.layers = parseLayerExpressions(o.layerTexts);
    if (o.lightNoise) o.lightGroups = true;
    if (!o.cryptomatteText.empty()) o.mattes = parseMatteTypes(o.cryptomatteText);
    if (!o.cropText.empty()) o.crop = parseCrop(o.cropText);
    if (!o.replayText.empty()) o.replay = parseReplay(o.replayText);
    if (o.countSetup && !o.timeSeconds) {
        throw UsageError(
            "--count-setup: expected together with --time; add --time or leave it out");
    }
    checkPieces(o);
    checkAccuracy(o);
    if (o.scene.empty()) {
        throw UsageError("SCENE.glb: expected the scene to render, found none; see --help");
    }
    if (o.effects) return;
    checkMethod(o);
    if (o.output.empty() && !o.replay && !o.estimate && !o.inMemory) nameOutput(o);
    const char* const layers = layerOption(o);
    if (layers && !o.replay && o.sheet.empty() && !o.output.empty() &&
        endingOf(o.output) != ".exr") {
        throw UsageError(std::string(layers) +
                         ": expected an .exr or a --sheet to hold the layers, found '" + o.output +
                         "'");
    }
    if (o.replay || o.output.empty()) return;
    const std::string ending = endingOf(o.output);
    if (const char* const style = exrOption(o); style && ending != ".exr") {
        throw UsageError(std::string(style) + ": expected an .exr, found '" + o.output +
                         "'; leave it out");
    }
    if (o.transparentBackground && ending != ".exr" && ending != ".png") {
        throw UsageError(
            "--transparent-background: expected an .exr or .png to hold alpha, found '" + o.output +
            "'");
    }
}

void addExrOptions(CLI::App& app, ExrStyle& style, const std::string& group) {
    app.add_flag("--half", style.half,
                 "16-bit float in the .exr, except for Z, position, variances and Cryptomatte")
        ->group(group);
    app.add_flag("--multi-part", style.multiPart,
                 "Make each layer of the .exr a part of its own: one of many layers is then read "
                 "more quickly")
        ->group(group);
}

const MethodRow& namedRow(const RenderOptions& o) {
    if (o.method == kAuto) return findMethod("bpt");
    const auto own = std::ranges::find(o.ownMethods, o.method, &MethodRow::name);
    return own != o.ownMethods.end() ? *own : findMethod(o.method, "--method");
}

void checkOutputs(const RenderOptions& o) {
    const NamedFile results[] = {{"-o", o.output},
                                 {"--sheet", o.sheet},
                                 {"--log", o.log},
                                 {"--json", o.common.json},
                                 {"--checkpoint", o.checkpoint}};
    const NamedFile inputs[] = {
        {"the scene", o.scene}, {"--reference", o.reference}, {"--env", o.environment}};
    requireOwnFiles(results, inputs);
    if (!o.output.empty() && !o.estimate) requireWritable(o.output);
    for (const std::string* path : {&o.sheet, &o.log, &o.common.json, &o.checkpoint}) {
        if (!path->empty()) const AtomicFile probe(*path);
    }
}

}  // namespace lacuna
