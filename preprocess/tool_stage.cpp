#include "preprocess/tool_stage.h"

#include <sys/resource.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/gltf/gltf.h"

namespace lacuna {

void addBuildOptions(CLI::App& app, BuildOptions& options) {
    app.add_option("SCENE", options.scene, "Scene: .glb or .gltf")
        ->type_name("SCENE.glb")
        ->required();
    app.add_option("-o,--output", options.output, "Result (default: in the scene's cache)")
        ->type_name("FILE");
    addCommonOptions(app, options.common);
}

void addVoxelOptions(CLI::App& app, BuildOptions& options) {
    app.add_option("--resolution", options.resolution,
                   "Voxels along the longest side, 8 to 1024 (default: 128)")
        ->type_name("N");
    app.add_option("--domain", options.domain,
                   "Box to voxelize, the scene's coordinates (default: what the camera reaches)")
        ->type_name("x0,y0,z0,x1,y1,z1");
}

VoxelizeSettings checkedSettings(const BuildOptions& options) {
    if (options.resolution < kLowestResolution || options.resolution > kHighestResolution) {
        throw UsageError(
            "--resolution: expected an integer from " + std::to_string(kLowestResolution) + " to " +
            std::to_string(kHighestResolution) + ", found " + std::to_string(options.resolution));
    }
    if (!options.domain.empty()) parseDomain(options.domain);
    const std::string& json = options.common.json;
    if (!json.empty() && (json == options.output || json == options.scene)) {
        throw UsageError("--json: expected a file of its own, found " + json);
    }
    if (!options.output.empty() && options.output == options.scene) {
        throw UsageError("-o: expected a file of its own, found the scene, " + options.scene);
    }
    if (!json.empty()) const AtomicFile probe(json);
    return {int(options.resolution), options.domain};
}

std::unique_ptr<Scene> loadScene(const std::string& file, const ThreadPool& pool) {
    SceneDescription description;
    pool.run([&] { description = loadGltf(file); });
    return std::make_unique<Scene>(std::move(description), pool);
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
