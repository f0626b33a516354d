#include "preprocess/skeletonize.h"

#include <limits>

#include "libcore/voxel/surface_distance.h"

namespace lacuna {

Skeletonized skeletonize(const Scene& scene, const VoxelFile& voxels, const ThreadPool& pool,
                         const std::atomic<bool>& cancel, Phases& phases) {
    const VoxelSpace& space = voxels.space;
    Skeletonized result;
    result.file.stamp = voxels.stamp;
    phases.run("topology", [&] { result.empty = emptySpaceBetti(space); });
    {
        std::optional<Thinned> thinned;
        phases.run("thinning", [&] { thinned.emplace(thin(space, pool, cancel)); });
        result.rounds = thinned->rounds;
        result.punctures = thinned->punctures;
        result.squares = thinned->squares;
        phases.run("balls", [&] {
            const std::vector<Triangle> triangles = scene.blockingTriangles(pool);
            const SurfaceDistance surface(triangles, pool);
            const auto radiusAt = [&](const Vec3d& p) {
                return surface(p, std::numeric_limits<double>::infinity());
            };
            result.raw = extractGraph(thinned->complex, space.shape, radiusAt, pool);
        });
    }
    result.skeleton = {result.raw.b0(), result.raw.b1(), 0};
    Skeleton& skeleton = result.file.skeleton;
    phases.run("filter", [&] {
        FilteredGraph filtered = filterByMaximalBalls(result.raw);
        result.filtered = {filtered.b0(), filtered.b1(), 0};
        skeleton.nodes = std::move(filtered.nodes);
        skeleton.edges = std::move(filtered.edges);
    });
    phases.run("node map", [&] { skeleton.map = mapNodes(space, skeleton.nodes, pool, cancel); });
    result.file.contentHash = skeleton.contentHash();
    return result;
}

}  // namespace lacuna
