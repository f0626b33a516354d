// lacuna-relight: new intensities and colours for the lamps of a picture, without rendering again.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/own_files.h"
#include "libcore/bidir/path_layers.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "libcore/tool/tool.h"
#include "render/output.h"
#include "render/relight.h"

namespace lacuna {
namespace {

struct RelightCommand {
    std::string image, output;
    std::vector<std::string> lights;
    CommonOptions common;
};

void declare(CLI::App& app, RelightCommand& options) {
    app.add_option("IMAGE", options.image, "Image written by lacuna-render --light-groups")
        ->required()
        ->type_name("IMAGE.exr");
    app.add_option("-o,--output", options.output,
                   "The picture under new light: .exr (all layers), .png or .pfm; without it the "
                   "groups are listed")
        ->type_name("FILE");
    app.add_option("--light", options.lights,
                   "Multiply the light of a group by a number, or by one for each of R, G and B; "
                   "may be repeated")
        ->type_name("GROUP=FACTOR|GROUP=R,G,B")
        ->allow_extra_args(false);
    addCommonOptions(app, options.common);
    app.footer(
        "Groups that are not named stay as they are; a factor of 0 turns a group off. The .exr "
        "has\n"
        "the picture, its groups (so that it can be relit again), and what does not depend on the\n"
        "light: albedo, normal, Z, the header. Its `relit` says by what each group was "
        "multiplied.\n"
        "variance, the noise, is known where all factors are the same, and for any factors of a\n"
        "picture that was rendered with --light-noise; else it is left out.\n"
        "--cache, --threads and --seed are accepted as by every tool and change nothing here.\n"
        "Examples:\n"
        "  lacuna-render hall.glb -o hall.exr --light-noise --time 1h\n"
        "  lacuna-relight hall.exr\n"
        "  lacuna-relight hall.exr -o evening.exr --light sun=0.1 --light lamps=2,1.8,1.4\n"
        "Exit codes: 0 done, 1 failed while running, 2 usage, 3 the image cannot be used.");
}

void requireOutputs(const RelightCommand& options) {
    const NamedFile results[] = {{"-o", options.output}, {"--json", options.common.json}};
    const NamedFile inputs[] = {{"the image", options.image}};
    requireOwnFiles(results, inputs);
    if (!options.output.empty()) {
        requireWritable(options.output);
    } else if (!options.lights.empty()) {
        throw UsageError("--light: expected together with -o; add -o FILE or leave it out");
    }
    if (!options.common.json.empty()) const AtomicFile probe(options.common.json);
}

double meanOf(const LayeredImage& image, const std::string& layer) {
    double sum = 0.0;
    for (const Rgb& p : image.rgb(layer).pixels) sum += double(mean(p));
    return sum / (double(image.width()) * double(image.height()));
}

/// Each group's share of the picture's light.
nlohmann::json sharesOf(const LayeredImage& image, const std::vector<std::string>& groups) {
    const double all = meanOf(image, "");
    nlohmann::json shares = nlohmann::json::object();
    for (const std::string& group : groups) {
        shares[group] = all > 0.0 ? meanOf(image, lightLayer(group)) / all : 0.0;
    }
    return shares;
}

void list(const nlohmann::json& shares) {
    for (const auto& [group, share] : shares.items()) {
        std::printf("%s: %.3g %% of the light\n", group.c_str(), 100.0 * share.get<double>());
    }
}

}  // namespace

int relightTool(int argc, char** argv) {
    CLI::App app("Changes the lamps of a rendered picture", "lacuna-relight");
    RelightCommand options;
    declare(app, options);
    if (const auto done = parseCommandLine(app, argc, argv)) return *done;
    requireOutputs(options);
    LightFactors factors;
    for (const std::string& text : options.lights) addLightFactor(factors, "--light", text);

    // Called also without -o, when there are no factors, so that pictures that cannot be relit are
    // refused.
    const LayeredImage image = relight(readExrLayers(options.image), factors, options.image);
    if (!options.output.empty()) writeImage(options.output, image);
    const std::vector<std::string> groups = lightGroupsOf(image, options.image);
    const nlohmann::json shares = sharesOf(image, groups);
    const bool noise = image.hasRgb("variance");
    if (!options.common.json.empty()) {
        writeJson(options.common.json, {{"shares", shares}, {"variance", noise}});
    }
    if (options.output.empty()) {
        list(shares);
        return 0;
    }
    if (!noise && !options.common.quiet) {
        std::fprintf(stderr,
                     "note: %s: written without variance, which does not follow from these layers: "
                     "render with --light-noise\n",
                     options.output.c_str());
    }
    std::printf("%s: %d x %d pixels under new light, %zu groups\n", options.output.c_str(),
                image.width(), image.height(), groups.size());
    return 0;
}

}  // namespace lacuna
