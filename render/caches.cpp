#include "render/caches.h"

#include <chrono>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "preprocess/skeletonize.h"
#include "preprocess/train.h"

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

/// What loading has to do with, and what it reports.
struct Loading {
    const RenderOptions& options;
    const Settings& settings;
    const Scene& scene;
    const ThreadPool& pool;
    const std::atomic<bool>& cancel;
    Progress& progress;
    Phases& phases;

    const std::string& hash() const { return scene.description().contentHash; }
    std::string directory() const {
        return cacheDirectory(options.scene, options.common.cacheDirectory);
    }
    void sayBuilt(const std::string& path) const {
        if (options.common.verbose) progress.remark("built " + path);
    }
};

void loadSkeleton(const Loading& l, Caches& caches) {
    const VoxelSettings voxelSettings = voxelOptions().read(l.settings, "voxels.");
    const std::string& hash = l.hash();
    const CacheStamp stamp = voxelStamp(hash, voxelSettings.resolution, voxelSettings.domain);
    const std::string path = cacheFile(l.directory(), stamp, "skeleton.vdb");
    const std::string resolution = " --resolution " + std::to_string(voxelSettings.resolution);
    const std::string remedy = "add --prepare, or run lacuna-voxelize" + resolution + " " +
                               l.options.scene + " and then lacuna-skeletonize" + resolution + " " +
                               l.options.scene;
    std::optional<SkeletonFile> file;
    l.phases.run("read skeleton", [&] {
        file = readOrNothing<SkeletonFile>(
            [&] { return readSkeletonFile(path, hash, l.scene.centre(), remedy); }, l.pool,
            l.options.prepare);
    });
    if (!file) {
        const std::string voxelPath = cacheFile(l.directory(), stamp, "voxels.vdb");
        makeCacheDirectory(path);
        std::optional<VoxelFile> voxels;
        l.phases.run("read voxels", [&] {
            voxels = readOrNothing<VoxelFile>(
                [&] { return readVoxelFile(voxelPath, hash, l.scene.centre(), remedy); }, l.pool,
                true);
        });
        if (!voxels) {
            voxels = voxelizeScene(l.scene, voxelSettings, l.pool, l.cancel, l.phases).file;
            l.pool.run([&] { writeVoxelFile(voxelPath, *voxels, l.scene.centre()); });
        }
        file = skeletonize(l.scene, *voxels, l.pool, l.cancel, l.phases).file;
        l.pool.run([&] { writeSkeletonFile(path, *file, l.scene.centre()); });
        l.sayBuilt(path);
    }
    caches.hashes["skeleton"] = file->contentHash;
    caches.skeleton = std::make_shared<const Skeleton>(std::move(file->skeleton));
}

void loadSubspaces(const Loading& l, Caches& caches) {
    TrainSettings t;  // with the default seed, whatever the picture's: the result is one
    static_cast<TrainingSettings&>(t) = trainingOptions().read(l.settings, "train.");
    const std::string path = cacheFile(l.directory(), t.stamp(l.hash()), "subspaces");
    const std::string remedy =
        "add --prepare, or run lacuna-train " + trainOptions(t) + " " + l.options.scene;
    std::optional<SubspaceFile> file;
    l.phases.run("read subspaces", [&] {
        file = readOrNothing<SubspaceFile>([&] { return readSubspaceFile(path, l.hash(), remedy); },
                                           l.pool, l.options.prepare);
    });
    if (!file) {
        makeCacheDirectory(path);
        file = train(l.scene, t, l.pool, l.cancel, l.phases).file;
        writeSubspaceFile(path, *file);
        l.sayBuilt(path);
    }
    caches.hashes["subspaces"] = file->contentHash;
    caches.subspaces = std::make_shared<const Subspaces>(std::move(file->subspaces));
}

}  // namespace

void Caches::giveTo(Method& method) const {
    AssetSet assets;
    if (skeleton) assets.put(skeleton);
    if (subspaces) assets.put(subspaces);
    method.use(assets);
}

Caches loadCaches(const RenderOptions& options, const MethodRow& row, const Settings& settings,
                  const Scene& scene, const ThreadPool& pool, const std::atomic<bool>& cancel,
                  Progress& progress) {
    Caches caches;
    if (row.needs.empty()) {
        if (options.prepare) {
            progress.remark("--prepare: " + row.name + " needs no caches: nothing to build");
        }
        return caches;
    }
    Phases phases([&](const std::string& name) { progress.phase(name); });
    Phases total;
    const Loading loading{options, settings, scene, pool, cancel, progress, phases};
    total.run("all", [&] {
        for (const AssetNeed& need : row.needs) {
            if (need.name == "skeleton") loadSkeleton(loading, caches);
            if (need.name == "subspaces") loadSubspaces(loading, caches);
        }
    });
    caches.phaseSeconds = phases.seconds();
    caches.seconds = total.seconds().at("all");
    return caches;
}

}  // namespace lacuna
