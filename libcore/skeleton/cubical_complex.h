// The empty space as a closed cubical complex [Chaussard13]: every Empty voxel with its faces,
// edges and corners. Two voxels that share a corner share a cell, so its topology is that of the
// 26-connected empty space (6-connected solid), and by the closed test of voxelize.h no triangle
// touches any of its cells: whatever is left of it after thinning lies in empty space.
#pragma once

#include <atomic>
#include <bit>

#include "libcore/voxel/grid.h"

namespace lacuna {

/// Axes that a cell extends along, as bits (1 = x, 2 = y, 4 = z): 0 point, 7 cube.
using CellAxes = unsigned;

/// A cell is the lattice corner with the lowest coordinates and its axes; a byte per corner says
/// which of its eight cells there are. The array has a border of absent cells, so that neighbours
/// need no test.
class CubicalComplex {
  public:
    using Corner = std::size_t;  ///< index into the bordered array

    /// All cells of the Empty voxels.
    explicit CubicalComplex(const VoxelSpace& space);

    std::size_t corners() const { return cells_.size(); }
    Corner corner(const VoxelIndex& v) const {
        return (std::size_t(v[2] + 1) * step_[2]) + std::size_t(v[1] + 1) * step_[1] +
               std::size_t(v[0] + 1);
    }
    VoxelIndex indexOf(Corner c) const {
        return {int(c % step_[1]) - 1, int(c % step_[2] / step_[1]) - 1, int(c / step_[2]) - 1};
    }
    /// What to add to a Corner for its neighbour along `axis` (0, 1, 2).
    std::size_t step(int axis) const { return step_[std::size_t(axis)]; }

    std::uint8_t cells(Corner c) const { return cells_[c]; }
    bool has(Corner c, CellAxes axes) const { return cells_[c] >> axes & 1u; }
    /// Safe from many threads at once.
    void remove(Corner c, CellAxes axes) {
        std::atomic_ref(cells_[c]).fetch_and(std::uint8_t(~(1u << axes)),
                                             std::memory_order_relaxed);
    }

    /// How many cells of one dimension more have the cell as a face.
    int cofaces(Corner c, CellAxes axes) const {
        int n = 0;
        for (int a = 0; a < 3; ++a) {
            const CellAxes bit = 1u << a;
            if (axes & bit) continue;
            n += int(has(c, axes | bit)) + int(has(c - step(a), axes | bit));
        }
        return n;
    }
    /// Largest of `values` (one per corner: of the cube there) over the cubes about the cell.
    template <class T>
    T largestAround(Corner c, CellAxes axes, const std::vector<T>& values) const {
        T best{};
        for (CellAxes back = 0; back < 8; ++back) {
            if (back & axes) continue;
            Corner cube = c;
            for (int a = 0; a < 3; ++a) cube -= back >> a & 1u ? step(a) : 0;
            best = std::max(best, values[cube]);
        }
        return best;
    }

    /// Points - edges + squares - cubes.
    std::int64_t euler() const;
    std::size_t count(int dimension) const;

  private:
    std::array<std::size_t, 3> step_;
    std::vector<std::uint8_t> cells_;
};

}  // namespace lacuna
