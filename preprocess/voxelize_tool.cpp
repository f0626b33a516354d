// lacuna-voxelize: the solid voxels of a scene, its empty space and the distances in it.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/parallel.h"
#include "libcore/tool/interrupt.h"
#include "libcore/tool/progress.h"
#include "libcore/tool/scene_stage.h"
#include "libcore/tool/table_options.h"
#include "preprocess/tool_stage.h"
#include "preprocess/voxelize.h"

namespace lacuna {
int voxelizeTool(int argc, char** argv) {
    CLI::App app("Finds the empty space of a glTF scene", "lacuna-voxelize");
    BuildOptions options;
    addBuildOptions(app, options);
    const TableOptions<VoxelSettings> voxels(app, voxelOptions());
    app.footer(
        "Writes KEY.voxels.vdb into the scene's cache: grids `solid` and `distance` in the\n"
        "scene's coordinates.\n"
        "Examples:\n"
        "  lacuna-voxelize door.glb\n"
        "  lacuna-voxelize door.glb --resolution 256 -o door.vdb\n"
        "Exit codes: 0 done, 1 failed while running, 2 usage, 3 the scene cannot be used, 130\n"
        "interrupted (nothing is written then).");
    if (const auto done = parseCommandLine(app, argc, argv)) return *done;
    const VoxelSettings settings = voxels.read();
    if (!settings.domain.empty()) parseDomain(settings.domain);
    checkBuildOptions(options);

    const ThreadPool pool = threadsOf(options.common);
    const InterruptGuard interrupt;
    TerminalProgress progress(options.common.quiet, interrupt.requested(), kNothingWritten);
    Phases phases([&](const std::string& name) { progress.phase(name); });
    Phases total;
    SceneStage stage;
    Voxelized result;
    std::string path;
    total.run("all", [&] {
        phases.run("load", [&] { stage = loadScene(options, LooksAt::Scene, pool, progress); });
        const CacheStamp stamp = voxelStamp(sceneInputs(stage), settings);
        path = resultFile(options, stamp, "voxels.vdb");
        result = voxelizeScene(*stage.scene, settings, stamp, pool, interrupt.requested(), phases);
        phases.run("write", [&] {
            pool.run([&] { writeVoxelFile(path, result.file, stage.scene->centre()); });
        });
    });

    const VoxelSpace& space = result.file.space;
    std::size_t counts[3] = {0, 0, 0};
    for (const VoxelState s : space.state) ++counts[std::size_t(s)];
    const std::size_t solid = counts[std::size_t(VoxelState::Solid)];
    const std::size_t empty = counts[std::size_t(VoxelState::Empty)];
    const double seconds = total.seconds().at("all");
    std::printf(
        "%s: %d x %d x %d voxels of %.4g, %zu solid, %zu empty in %zu of %zu parts, %.3g s\n",
        path.c_str(), space.shape.size[0], space.shape.size[1], space.shape.size[2],
        space.shape.voxel, solid, empty, result.parts.reached, result.parts.total, seconds);
    const Vec3d low = space.shape.box().low + stage.scene->centre();
    const Vec3d high = space.shape.box().high + stage.scene->centre();
    writeReport(options.common, {{"file", path},
                                 {"resolution", space.shape.size},
                                 {"voxel", space.shape.voxel},
                                 {"domain", {low.x, low.y, low.z, high.x, high.y, high.z}},
                                 {"solid_voxels", solid},
                                 {"empty_voxels", empty},
                                 {"unreached_voxels", counts[std::size_t(VoxelState::Unreached)]},
                                 {"parts", result.parts.total},
                                 {"reached_parts", result.parts.reached},
                                 {"content_hash", space.contentHash()},
                                 {"scene_hash", stage.scene->description().contentHash},
                                 {"phases", phases.seconds()},
                                 {"seconds", seconds},
                                 {"peak_bytes", peakBytes()}});
    return 0;
}

}  // namespace lacuna
