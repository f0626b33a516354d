#include "render/caches.h"

#include <chrono>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "preprocess/skeletonize.h"

namespace lacuna {
namespace {

/// Reads the file in the pool's threads; with `prepare` nothing where it cannot be used.
template <class File, class Read>
std::optional<File> readOrNothing(const Read& read, const ThreadPool& pool, bool prepare) {
    try {
        std::optional<File> file;
        pool.run([&] { file = read(); });
        return file;
    } catch (const InputError&) {
        if (!prepare) throw;
        return std::nullopt;
    }
}

}  // namespace

Caches loadCaches(const RenderOptions& options, const MethodRow& row, const Settings& settings,
                  const Scene& scene, const ThreadPool& pool, const std::atomic<bool>& cancel,
                  Progress& progress) {
    Caches caches;
    if (!row.needsSkeleton) {
        if (options.prepare) {
            progress.remark("--prepare: " + row.name + " needs no caches: nothing to build");
        }
        return caches;
    }
    Phases phases([&](const std::string& name) { progress.phase(name); });
    Phases total;
    total.run("all", [&] {
        const VoxelizeSettings voxelSettings{int(settings.integer("voxels.resolution")), {}};
        const std::string& hash = scene.description().contentHash;
        const CacheStamp stamp = voxelStamp(hash, voxelSettings.resolution, {});
        const std::string directory = cacheDirectory(options.scene, options.common.cacheDirectory);
        const std::string path = cacheFile(directory, stamp, "skeleton.vdb");
        const std::string resolution = " --resolution " + std::to_string(voxelSettings.resolution);
        const std::string remedy = "add --prepare, or run lacuna-voxelize" + resolution + " " +
                                   options.scene + " and then lacuna-skeletonize" + resolution +
                                   " " + options.scene;
        std::optional<SkeletonFile> file;
        phases.run("read skeleton", [&] {
            file = readOrNothing<SkeletonFile>(
                [&] { return readSkeletonFile(path, hash, scene.centre(), remedy); }, pool,
                options.prepare);
        });
        if (!file) {
            const std::string voxelPath = cacheFile(directory, stamp, "voxels.vdb");
            makeCacheDirectory(path);
            std::optional<VoxelFile> voxels;
            phases.run("read voxels", [&] {
                voxels = readOrNothing<VoxelFile>(
                    [&] { return readVoxelFile(voxelPath, hash, scene.centre(), remedy); }, pool,
                    true);
            });
            if (!voxels) {
                voxels = voxelizeScene(scene, voxelSettings, pool, cancel, phases).file;
                pool.run([&] { writeVoxelFile(voxelPath, *voxels, scene.centre()); });
            }
            file = skeletonize(scene, *voxels, pool, cancel, phases).file;
            pool.run([&] { writeSkeletonFile(path, *file, scene.centre()); });
            if (options.common.verbose) progress.remark("built " + path);
        }
        caches.hashes["skeleton"] = file->contentHash;
        caches.skeleton = std::make_shared<const Skeleton>(std::move(file->skeleton));
    });
    caches.phaseSeconds = phases.seconds();
    caches.seconds = total.seconds().at("all");
    return caches;
}

}  // namespace lacuna
