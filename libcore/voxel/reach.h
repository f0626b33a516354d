// What camera and light subpaths reach: it says how large the domain must be, and which parts of
// the empty space matter.
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

/// Some ten thousand subpaths of up to 12 edges from either end, with random numbers of their own
/// (a cache must not depend on --seed). Lights at infinity are left out: what they reach first is
/// the outside of the building.
Reach traceReach(const Scene& scene, const ThreadPool& pool);

/// Box of the triangles; low > high where there are none.
VoxelBox boundsOf(std::span<const Triangle> triangles);

/// The default domain: the box of where camera subpaths end, without the outermost 0.2 % of the
/// vertices along each axis (a few paths that leave through a window must not make the voxels
/// coarse), plus 10 %, but no more than the scene's own box. Without a camera: the scene's box.
VoxelBox defaultDomain(const Reach& reach, const VoxelBox& scene);

/// Turns the empty voxels of parts (26-connected) that no segment passes through from Empty into
/// Unreached. Without any segment all parts count as reached. Returns how many parts there are and
/// how many are reached.
struct PartCounts {
    std::size_t total = 0, reached = 0;
};
PartCounts keepReachedParts(const Reach& reach, const VoxelShape& shape,
                            std::span<VoxelState> state);

}  // namespace lacuna
