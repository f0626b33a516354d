// Voxel spaces defined by a function, with distances to the solid voxels themselves.
#pragma once

#include <functional>

#include "libcore/voxel/grid.h"

namespace lacuna::test {

using IsSolid = std::function<bool(int x, int y, int z)>;

/// Distance from `p` to the nearest Solid voxel, a closed cube. The grid's outside does not count,
/// because it is no surface. A large number if there is no Solid voxel.
double distanceToSolid(const VoxelSpace& space, const Vec3d& p);

/// A grid of voxels of size 1 with the low corner of voxel (0, 0, 0) at `origin`.
VoxelSpace drawn(const VoxelIndex& size, const IsSolid& solid, const Vec3d& origin = {});

/// A random space in which each voxel is solid with probability `solid`.
VoxelSpace randomSpace(const VoxelIndex& size, double solid, std::uint64_t seed);

}  // namespace lacuna::test
