// Conservative voxelization: every voxel that a triangle touches, touching in a point included.
#pragma once

#include <atomic>
#include <span>

#include "libcore/voxel/grid.h"

namespace lacuna {

class ThreadPool;

using Triangle = std::array<Vec3, 3>;

/// Throws Error with exit code 130 once `cancel` is set: nothing that is half done is of use.
void throwIfCancelled(const std::atomic<bool>& cancel);

/// A lattice over `domain` with `resolution` voxels along its longest side; the voxels' size is
/// such that the domain's walls run through the middle of the outer voxels. (A wall on a lattice
/// plane touches the voxels on both sides and would be two voxels thick.)
VoxelShape latticeOver(const VoxelBox& domain, int resolution);
/// A lattice whose low corner is exactly the domain's: for domains that a user gave.
VoxelShape latticeExactlyOver(const VoxelBox& domain, int resolution);

/// Sets the voxels that a triangle touches to Solid and leaves the others. Closed boxes and an
/// exact test: two empty voxels that share as much as a corner have no triangle between them, so
/// the empty space is the 26-connected one and nothing leaks through a wall, however thin.
void voxelize(std::span<const Triangle> triangles, const VoxelShape& shape,
              std::span<VoxelState> state, const ThreadPool& pool, const std::atomic<bool>& cancel);

}  // namespace lacuna
