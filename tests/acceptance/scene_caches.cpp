#include "tests/acceptance/scene_caches.h"

#include "libcore/base/error.h"
#include "preprocess/skeletonize.h"
#include "preprocess/train.h"

namespace lacuna::test {

namespace {

const std::atomic<bool> never{false};

std::shared_ptr<const Skeleton> skeletonOf(const Scene& scene, const ThreadPool& pool) {
    Phases phases;
    VoxelSettings settings;
    settings.resolution = 24;
    const Voxelized voxels = voxelizeScene(scene, settings, {}, pool, never, phases);
    Skeletonized made = skeletonize(scene, voxels.file, pool, never, phases);
    return std::make_shared<const Skeleton>(std::move(made.file.skeleton));
}

std::shared_ptr<const Subspaces> subspacesOf(const Scene& scene, const ThreadPool& pool) {
    Phases phases;
    TrainSettings settings;
    settings.paths = 4000;
    settings.subspaces = 40;
    settings.lightPaths = 20000;
    settings.epochs = 4;
    const TrainingView view =
        trainingView(scene.makeCamera("", {16, 9}, {}), 16.0 / 9.0, WalkLimits{}, settings.paths);
    return std::make_shared<const Subspaces>(
        std::move(train(scene, view, settings, {}, pool, never, phases).file.subspaces));
}

}  // namespace

void giveCaches(Method& method, const MethodRow& row, const Scene& scene, const ThreadPool& pool) {
    try {
        AssetSet assets;
        for (const AssetNeed& need : row.needs) {
            if (need.name == "skeleton") assets.put(skeletonOf(scene, pool));
            if (need.name == "subspaces") assets.put(subspacesOf(scene, pool));
        }
        method.use(assets);
    } catch (const InputError&) {  // no surface
    } catch (const UsageError&) {  // only solid voxels, as in a scene that is nothing but a floor
    }
}

}  // namespace lacuna::test
