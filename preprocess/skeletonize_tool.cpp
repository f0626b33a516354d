// lacuna-skeletonize: the curve skeleton of a scene's empty space and the map of its nodes.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/own_files.h"
#include "libcore/base/parallel.h"
#include "libcore/tool/interrupt.h"
#include "libcore/tool/progress.h"
#include "libcore/tool/scene_stage.h"
#include "libcore/tool/table_options.h"
#include "preprocess/skeletonize.h"
#include "preprocess/tool_stage.h"

namespace lacuna {
namespace {

nlohmann::json graphJson(std::size_t nodes, std::size_t edges, const Betti& b) {
    return {{"nodes", nodes}, {"edges", edges}, {"b0", b.b0}, {"b1", b.b1}};
}

}  // namespace

int skeletonizeTool(int argc, char** argv) {
    CLI::App app("Finds the curve skeleton of a scene's empty space", "lacuna-skeletonize");
    BuildOptions options;
    std::string voxelPath, graphPath;
    addBuildOptions(app, options);
    const TableOptions<VoxelSettings> voxels(app, voxelOptions());
    app.add_option("--voxels", voxelPath, "Voxels to start from (default: those in the cache)")
        ->type_name("FILE");
    app.add_option("--graph", graphPath, "Skeleton and balls for viewers, .glb")
        ->type_name("FILE.glb");
    app.footer(
        "Reads KEY.voxels.vdb of lacuna-voxelize, which must have been run with the same\n"
        "--resolution and --domain, and writes KEY.skeleton.vdb beside it.\n"
        "Examples:\n"
        "  lacuna-skeletonize door.glb\n"
        "  lacuna-skeletonize door.glb --graph door-skeleton.glb\n"
        "Exit codes: 0 done, 1 failed while running, 2 usage, 3 scene or voxels cannot be used,\n"
        "130 interrupted (nothing is written then).");
    if (const auto done = parseCommandLine(app, argc, argv)) return *done;
    const VoxelSettings settings = voxels.read();
    if (!settings.domain.empty()) parseDomain(settings.domain);
    checkBuildOptions(options);
    const NamedFile results[] = {
        {"-o", options.output}, {"--json", options.common.json}, {"--graph", graphPath}};
    const NamedFile sources[] = {
        {"the scene", options.scene}, {"--env", options.environment}, {"--voxels", voxelPath}};
    requireOwnFiles(results, sources);
    if (!graphPath.empty()) const AtomicFile probe(graphPath);

    const ThreadPool pool = threadsOf(options.common);
    const InterruptGuard interrupt;
    TerminalProgress progress(options.common.quiet, interrupt.requested(), kNothingWritten);
    Phases phases([&](const std::string& name) { progress.phase(name); });
    Phases total;
    SceneStage stage;
    Skeletonized result;
    std::string path;
    total.run("all", [&] {
        phases.run("load", [&] { stage = loadScene(options, LooksAt::Scene, pool, progress); });
        // The user may name voxels of any resolution, but they must be of this scene.
        const Settings inputs = sceneInputs(stage);
        CacheStamp expected{inputs};
        if (voxelPath.empty()) {
            expected = voxelStamp(inputs, settings);
            voxelPath = cacheFile(cacheDirectory(options.scene, options.common.cacheDirectory),
                                  expected, "voxels.vdb");
        }
        VoxelFile voxelFile;
        phases.run("read", [&] {
            const std::string remedy = "run lacuna-voxelize" +
                                       optionArguments(changedValues(voxelOptions(), settings)) +
                                       sceneArguments(options) + " " + shellQuoted(options.scene);
            pool.run([&] {
                voxelFile = readVoxelFile(voxelPath, expected, stage.scene->centre(), remedy);
            });
        });
        path = resultFile(options, voxelFile.stamp, "skeleton.vdb");
        result = skeletonize(*stage.scene, voxelFile, pool, interrupt.requested(), phases);
        phases.run("write", [&] {
            pool.run([&] { writeSkeletonFile(path, result.file, stage.scene->centre()); });
            if (!graphPath.empty()) writeGraphGlb(graphPath, result, stage.scene->centre());
        });
    });

    const Skeleton& skeleton = result.file.skeleton;
    const double seconds = total.seconds().at("all");
    std::printf(
        "%s: empty space b0 %lld b1 %lld b2 %lld; skeleton %zu nodes, %zu edges, b0 %lld b1 %lld; "
        "filtered %zu nodes, %zu edges, b0 %lld b1 %lld; %.3g s\n",
        path.c_str(), (long long)result.empty.b0, (long long)result.empty.b1,
        (long long)result.empty.b2, result.raw.nodes.size(), result.raw.edges.size(),
        (long long)result.skeleton.b0, (long long)result.skeleton.b1, skeleton.nodes.size(),
        skeleton.edges.size(), (long long)result.filtered.b0, (long long)result.filtered.b1,
        seconds);
    if (result.skeleton.b0 != result.empty.b0 || result.skeleton.b1 != result.empty.b1) {
        progress.warning("warning: " + path +
                         ": the skeleton has other loops than the empty space (" +
                         std::to_string(result.squares) + " squares could not be collapsed)");
    }
    writeReport(
        options.common,
        {{"file", path},
         {"empty_space",
          {{"b0", result.empty.b0},
           {"b1", result.empty.b1},
           {"b2", result.empty.b2},
           {"euler", result.empty.euler()}}},
         {"skeleton", graphJson(result.raw.nodes.size(), result.raw.edges.size(), result.skeleton)},
         {"filtered", graphJson(skeleton.nodes.size(), skeleton.edges.size(), result.filtered)},
         {"rounds", result.rounds},
         {"punctures", result.punctures},
         {"squares", result.squares},
         {"node_map_bytes", skeleton.map.entries().size_bytes()},
         {"content_hash", result.file.contentHash},
         {"phases", phases.seconds()},
         {"seconds", seconds},
         {"peak_bytes", peakBytes()}});
    return 0;
}

}  // namespace lacuna
