// Connected components of voxels, by runs along x: a union-find over runs visits a voxel once.
#pragma once

#include <span>
#include <vector>

#include "libcore/voxel/grid.h"

namespace lacuna {

/// Which voxels connect: by faces, or by corners and edges too.
enum class Connectivity { Faces, Corners };

class Components {
  public:
    /// Of the voxels whose state is Solid (or the others: `solid` false). With `outside` the space
    /// around the grid counts as such voxels as well. Unreached counts as Solid where
    /// `unreachedIsSolid`.
    struct Which {
        bool solid = false;
        bool unreachedIsSolid = false;
        bool outside = false;
    };
    Components(const VoxelShape& shape, std::span<const VoxelState> state, Which which,
               Connectivity connectivity);

    std::size_t count() const { return count_; }
    /// Component of a voxel inside the grid, in [0, count()), by the order of their first voxels;
    /// -1 where the voxel is not of the kind.
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
    std::vector<std::uint32_t> row_;     // first run of each row, and the end
    std::vector<std::uint32_t> number_;  // by run: of its component
    std::size_t count_ = 0;
};

}  // namespace lacuna
