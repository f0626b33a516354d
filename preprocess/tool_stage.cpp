#include "preprocess/tool_stage.h"

#include <sys/resource.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

#include "libcore/base/atomic_file.h"
#include "libcore/base/own_files.h"

namespace lacuna {

void addBuildOptions(CLI::App& app, BuildOptions& options) {
    app.add_option("SCENE", options.scene, "Scene: .glb or .gltf")
        ->type_name("SCENE.glb")
        ->required();
    app.add_option("-o,--output", options.output, "Result (default: in the scene's cache)")
        ->type_name("FILE");
    addCommonOptions(app, options.common);
    addSceneOptions(app, options);
}

void checkBuildOptions(BuildOptions& options) {
    checkSceneOptions(options);
    const std::string& json = options.common.json;
    const NamedFile results[] = {{"-o", options.output}, {"--json", json}};
    const NamedFile inputs[] = {{"the scene", options.scene}, {"--env", options.environment}};
    requireOwnFiles(results, inputs);
    if (!json.empty()) const AtomicFile probe(json);
}

std::string resultFile(const BuildOptions& options, const CacheStamp& stamp,
                       const std::string& kind) {
    std::string path = options.output;
    if (path.empty()) {
        path = cacheFile(cacheDirectory(options.scene, options.common.cacheDirectory), stamp, kind);
        makeCacheDirectory(path);
    }
    const AtomicFile probe(path);
    return path;
}

std::uint64_t peakBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024u;
}

void writeReport(const CommonOptions& options, const nlohmann::json& report) {
    if (!options.json.empty()) writeFileAtomically(options.json, report.dump(2) + "\n");
}

}  // namespace lacuna
