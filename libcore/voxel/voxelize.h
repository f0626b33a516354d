// Conservative voxelization: every voxel that a triangle touches, even in one point.
#pragma once

#include <atomic>
#include <span>

#include "libcore/voxel/grid.h"

namespace lacuna {

class ThreadPool;

using Triangle = std::array<Vec3, 3>;

/// Throws InterruptedError if `cancel` is set: a half-finished result is of no use.
void throwIfCancelled(const std::atomic<bool>& cancel);

/// A lattice over `domain` with `resolution` voxels along its longest side. The size of the voxels
/// is such that the domain's walls run through the middle of the outer voxels. (A wall on a lattice
/// plane touches the voxels on both sides and would be two voxels thick.)
VoxelShape latticeOver(const VoxelBox& domain, int resolution);
/// A lattice whose low corner is exactly the domain's, for domains given by the user.
VoxelShape latticeExactlyOver(const VoxelBox& domain, int resolution);

/// Sets the voxels that a triangle touches to Solid and leaves the others. Boxes are closed and the
/// test is exact: no triangle passes between two empty voxels that share even a corner. The empty
/// space is therefore 26-connected, and nothing leaks through a wall, however thin.
void voxelize(std::span<const Triangle> triangles, const VoxelShape& shape,
              std::span<VoxelState> state, const ThreadPool& pool, const std::atomic<bool>& cancel);

}  // namespace lacuna
