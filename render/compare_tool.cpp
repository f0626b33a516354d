// lacuna-compare: the four error measures (error_metrics.h) between an image and a reference.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/own_files.h"
#include "libcore/image/error_map.h"
#include "libcore/image/error_metrics.h"
#include "libcore/image/image_io.h"
#include "libcore/tool/tool.h"

namespace lacuna {
namespace {

struct CompareCommand {
    std::string image;
    std::string reference;
    std::string errorMap;
    CommonOptions common;
};

void declare(CLI::App& app, CompareCommand& options) {
    app.add_option("IMAGE", options.image, "Image: .exr (R, G, B), .hdr, .pfm or .png")->required();
    app.add_option("REFERENCE", options.reference, "Image that it should be, of the same size")
        ->required();
    app.add_option("--error-map", options.errorMap,
                   std::string("False-colour picture of ") + kErrorMapScale)
        ->type_name("FILE.png");
    addCommonOptions(app, options.common);
    app.footer(
        "Prints mae, rmse, mape, relmse (one `name value` per line) and the number of pixels. "
        "With\n"
        "image I, reference R, e = 0.01 mean R, means over all pixels and channels:\n"
        "  mae  = mean |I - R|              rmse   = sqrt(mean (I - R)^2)\n"
        "  mape = mean |I - R| / (R + e)    relmse = mean (I - R)^2 / (R^2 + e^2)\n"
        "Black reference: mape and relmse are 0 where I = R everywhere, else inf. JSON has no\n"
        "infinity: in --json they are then the string \"inf\". --cache, --threads and --seed are\n"
        "accepted as by every tool and change nothing here.\n"
        "Examples:\n"
        "  lacuna-compare door.exr reference.exr --error-map door-errors.png\n"
        "Exit codes: 0 done, 1 failed while running, 2 usage, 3 an image cannot be used.");
}

void requireOutputs(const CompareCommand& options) {
    const NamedFile results[] = {{"--error-map", options.errorMap},
                                 {"--json", options.common.json}};
    const NamedFile inputs[] = {{"the image", options.image}, {"the reference", options.reference}};
    requireOwnFiles(results, inputs);
    if (!options.errorMap.empty()) {
        if (endingOf(options.errorMap) != ".png") {
            throw UsageError(options.errorMap + ": expected an error map ending in .png, found '" +
                             endingOf(options.errorMap) + "'; choose another name");
        }
        requireWritable(options.errorMap);
    }
    if (!options.common.json.empty()) const AtomicFile probe(options.common.json);
}

nlohmann::json measureJson(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json("inf");
}

void writeMeasures(const std::string& path, const ErrorMeasures& m) {
    const nlohmann::json json{{"mae", measureJson(m.mae)},
                              {"rmse", measureJson(m.rmse)},
                              {"mape", measureJson(m.mape)},
                              {"relmse", measureJson(m.relmse)},
                              {"pixels", m.pixels}};
    writeFileAtomically(path, json.dump(2) + "\n");
}

}  // namespace

int compareTool(int argc, char** argv) {
    CLI::App app("Measures how far an image is from a reference", "lacuna-compare");
    CompareCommand options;
    declare(app, options);
    if (const auto done = parseCommandLine(app, argc, argv)) return *done;
    requireOutputs(options);

    const ImageFile imageFile = openImage(options.image);
    const ImageFile referenceFile = openImage(options.reference);
    requireSameSize(options.image, imageFile.size, options.reference, referenceFile.size);
    const Image image = imageFile.decode();
    const ErrorReference reference(referenceFile.decode(), options.reference);
    const ErrorMeasures m = reference.compare(image, options.image);
    if (options.common.verbose && !options.common.quiet) {
        std::fprintf(stderr, "%d x %d pixels, e = %.9g\n", image.width, image.height,
                     reference.epsilon());
    }
    if (!options.errorMap.empty()) {
        writePngBytes(options.errorMap, image.width, image.height,
                      errorMap(image, reference, options.image));
        if (!options.common.quiet) {
            std::fprintf(stderr, "%s: %s\n", options.errorMap.c_str(), kErrorMapScale);
        }
    }
    if (!options.common.json.empty()) writeMeasures(options.common.json, m);
    std::printf("mae %.17g\nrmse %.17g\nmape %.17g\nrelmse %.17g\npixels %zu\n", m.mae, m.rmse,
                m.mape, m.relmse, m.pixels);
    return 0;
}

}  // namespace lacuna
