// The work of lacuna-skeletonize, also for lacuna-render --prepare.
#pragma once

#include "libcore/cache/skeleton_file.h"
#include "libcore/skeleton/topology.h"
#include "preprocess/voxelize.h"

namespace lacuna {

struct Skeletonized {
    SkeletonFile file;
    SkeletonGraph raw;
    Betti empty;
    Betti skeleton, filtered;  ///< b2 is 0, because they are graphs
    std::size_t rounds = 0, punctures = 0, squares = 0;
};

/// Makes the skeleton of `voxels`. Throws RunError, or InterruptedError once `cancel` is set.
Skeletonized skeletonize(const Scene& scene, const VoxelFile& voxels, const ThreadPool& pool,
                         const std::atomic<bool>& cancel, Phases& phases);

/// The skeleton as a .glb for viewers: lines of the raw and of the filtered graph and the balls,
/// in the scene file's coordinates. Written atomically. Throws RunError.
void writeGraphGlb(const std::string& path, const Skeletonized& result, const Vec3d& centre);

}  // namespace lacuna
