// Connected components of voxels: union-find over runs along x, which visits each voxel once.
#pragma once

#include <span>
#include <vector>

#include "libcore/voxel/grid.h"

namespace lacuna {

/// Whether voxels are neighbours that share a face, or also an edge or corner.
enum class Connectivity { Faces, Corners };

class Components {
  public:
    /// Selects the voxels: those whose state is Solid, or the others if `solid` is false. With
    /// `outside`, the space around the grid is selected as well. With `unreachedIsSolid`, Unreached
    /// counts as Solid.
    struct Which {
        bool solid = false;
        bool unreachedIsSolid = false;
        bool outside = false;
    };
    Components(const VoxelShape& shape, std::span<const VoxelState> state, Which which,
               Connectivity connectivity);

    std::size_t count() const { return count_; }
    /// Component of a voxel inside the grid, in [0, count()), numbered in the order of their first
    /// voxels; -1 if the voxel is not selected.
    std::int64_t at(const VoxelIndex& v) const;

  private:
    struct Run {
        int begin, end;  // x, half open
        std::uint32_t parent;
    };
    std::uint32_t find(std::uint32_t run) const;
    void join(std::size_t rowA, std::size_t rowB, int reach);

    int pad_;
    VoxelIndex size_;  // padded
    std::vector<Run> runs_;
    std::vector<std::uint32_t> row_;     // first run of each row, and one past the last
    std::vector<std::uint32_t> number_;  // by run: number of its component
    std::size_t count_ = 0;
};

}  // namespace lacuna
