// Voxel spaces drawn by a function, with distances to the solid voxels themselves.
#pragma once

#include <functional>

#include "libcore/voxel/grid.h"

namespace lacuna::test {

using IsSolid = std::function<bool(int x, int y, int z)>;

/// Distance from `p` to the nearest Solid voxel, as closed cubes; the grid's outside does not count
/// (a surface is what light meets). A large number where there is none.
double distanceToSolid(const VoxelSpace& space, const Vec3d& p);

/// A grid of voxels of size 1 whose voxel (0, 0, 0) lies at `origin`.
VoxelSpace drawn(const VoxelIndex& size, const IsSolid& solid, const Vec3d& origin = {});

/// Each voxel solid with the given probability.
VoxelSpace randomSpace(const VoxelIndex& size, double solid, std::uint64_t seed);

}  // namespace lacuna::test
