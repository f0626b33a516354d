// The space that camera and light subpaths reach. It determines the size of the domain and which
// parts of the empty space matter.
#pragma once

#include "libcore/scene/scene.h"
#include "libcore/voxel/voxelize.h"

namespace lacuna {

/// Straight pieces of subpaths from one surface (or lens, or lamp) to the next, in the order of
/// paths.
struct Reach {
    using Segment = std::array<Vec3, 2>;
    std::vector<Segment> camera;  ///< from every camera of the scene
    std::vector<Segment> lamps;   ///< from lights within the scene; empty where there are none
};

/// Traces some ten thousand subpaths of up to 12 edges from every camera and from the lights, with
/// a fixed seed (a cache must not depend on --seed). Lights at infinity are left out: their
/// subpaths first reach the outside of the building.
Reach traceReach(const Scene& scene, const ThreadPool& pool);

/// Bounding box of the triangles; low > high if there are none.
VoxelBox boundsOf(std::span<const Triangle> triangles);

/// The default domain: the bounding box of the camera subpaths' vertices on surfaces, enlarged by
/// 10 % and clipped to the scene's own box. It ignores the outermost 0.2 % of the vertices along
/// each axis: a few paths that leave through a window must not make the voxels coarse. Without a
/// camera, it is the scene's box.
VoxelBox defaultDomain(const Reach& reach, const VoxelBox& scene);

/// Changes empty voxels from Empty to Unreached in all (26-connected) parts that no segment passes
/// through. Without any segment all parts count as reached. Returns the number of parts and of
/// reached parts.
struct PartCounts {
    std::size_t total = 0, reached = 0;
};
PartCounts keepReachedParts(const Reach& reach, const VoxelShape& shape,
                            std::span<VoxelState> state);

}  // namespace lacuna
