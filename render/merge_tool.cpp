// lacuna-merge: parts of a picture (lacuna-render --blocks) become the picture.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/own_files.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "libcore/tool/tool.h"
#include "render/merge.h"
#include "render/options.h"
#include "render/output.h"

namespace lacuna {
namespace {

struct MergeCommand {
    std::vector<std::string> parts;
    std::string output;
    bool gaps = false;
    ExrStyle exr;
    CommonOptions common;
};

void declare(CLI::App& app, MergeCommand& options) {
    app.add_option("PART", options.parts, "Parts written by lacuna-render --blocks, in any order")
        ->required()
        ->type_name("PART.exr");
    app.add_option("-o,--output", options.output, "The picture: .exr")
        ->required()
        ->type_name("OUT.exr");
    app.add_flag("--gaps", options.gaps, "Allow missing blocks");
    addExrOptions(app, options.exr, "Options");
    addCommonOptions(app, options.common);
    app.footer(
        "All parts together are the picture that one lacuna-render would have made, bit for bit;\n"
        "times are sums. Refused: parts of other commands (another scene, method, setting, seed,\n"
        "size, version), blocks that come twice, and, without --gaps, blocks that are missing.\n"
        "--cache and --seed are accepted as by every tool and change nothing here.\n"
        "Examples:\n"
        "  lacuna-render hall.glb -o part-0.exr --method bpt --iterations 128 --blocks 0,1\n"
        "  lacuna-render hall.glb -o part-1.exr --method bpt --iterations 128 --blocks 1,2\n"
        "  lacuna-merge part-0.exr part-1.exr -o hall.exr\n"
        "Exit codes: 0 done, 1 failed while running, 2 usage, 3 a part cannot be used.");
}

void requireOutputs(const MergeCommand& options) {
    if (endingOf(options.output) != ".exr") {
        throw UsageError(options.output +
                         ": expected a picture ending in .exr; choose another "
                         "name");
    }
    const NamedFile results[] = {{"-o", options.output}, {"--json", options.common.json}};
    std::vector<NamedFile> inputs;
    for (const std::string& part : options.parts) inputs.push_back({"a part", part});
    requireOwnFiles(results, inputs);
    requireWritable(options.output);
    if (!options.common.json.empty()) const AtomicFile probe(options.common.json);
}

}  // namespace

int mergeTool(int argc, char** argv) {
    CLI::App app("Puts the parts of a picture together", "lacuna-merge");
    MergeCommand options;
    declare(app, options);
    if (const auto done = parseCommandLine(app, argc, argv)) return *done;
    requireOutputs(options);

    const ThreadPool pool = threadsOf(options.common);
    Merged merged = mergeParts(options.parts, options.gaps, pool);
    for (const std::string& text : merged.warnings) {
        std::fprintf(stderr, "warning: %s\n", text.c_str());
    }
    merged.image.attributes["commandLine"] = commandLineText(argc, argv);
    writeExr(options.output, merged.image, options.exr);
    const FilmSum::MeanColour& m = merged.mean;
    if (!options.common.json.empty()) {
        writeJson(options.common.json, {{"parts", options.parts.size()},
                                        {"blocks", merged.blocks},
                                        {"iterations", merged.iterations},
                                        {"mean_rgb", numbersJson(m.mean)},
                                        {"mean_rgb_stderr", numbersJson(m.standardError)}});
    }
    std::printf("%s: %d x %d pixels, %llu iterations in %llu blocks of %zu parts\n",
                options.output.c_str(), merged.image.width(), merged.image.height(),
                static_cast<unsigned long long>(merged.iterations),
                static_cast<unsigned long long>(merged.blocks), options.parts.size());
    return 0;
}

}  // namespace lacuna
