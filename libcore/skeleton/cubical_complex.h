// The empty space as a closed cubical complex [Chaussard13]: every Empty voxel with its faces,
// edges and corners. Two voxels that share a corner share a cell, so that its topology is that of
// the 26-connected empty space (6-connected solid). By the closed test of voxelize.h, no triangle
// touches any of its cells: whatever thinning leaves of it lies in empty space.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>

#include "libcore/voxel/grid.h"

namespace lacuna {

/// Axes that a cell extends along, as bits (1 = x, 2 = y, 4 = z): 0 point, 7 cube.
using CellAxes = unsigned;

/// A cell is given by its lattice corner with the lowest coordinates and by its axes. Cells are
/// stored as bits, in words of 64 corners along x, so that one operation treats 64 cells. A row of
/// corners is a whole number of words. The array has a border of absent cells, so that access to
/// neighbours needs no range test.
class CubicalComplex {
  public:
    using Corner = std::size_t;  ///< index into the bordered array
    using Word = std::uint64_t;  ///< a bit for each of the corners 64 w .. 64 w + 63

    /// A displacement by at most one corner along each axis, in words and bits.
    struct Shift {
        std::ptrdiff_t words = 0;
        int bits = 0;  ///< -1, 0, 1

        friend Shift operator+(Shift a, Shift b) { return {a.words + b.words, a.bits + b.bits}; }
    };

    /// All cells of the Empty voxels.
    explicit CubicalComplex(const VoxelSpace& space);

    std::size_t corners() const { return words() * 64; }
    std::size_t words() const { return cells_.size() - 1; }
    Corner corner(const VoxelIndex& v) const {
        return (std::size_t(v[2] + 1) * step_[2]) + std::size_t(v[1] + 1) * step_[1] +
               std::size_t(v[0] + 1);
    }
    VoxelIndex indexOf(Corner c) const {
        return {int(c % step_[1]) - 1, int(c % step_[2] / step_[1]) - 1, int(c / step_[2]) - 1};
    }
    /// Offset from a Corner to its neighbour along `axis` (0, 1, 2).
    std::size_t step(int axis) const { return step_[std::size_t(axis)]; }
    Shift shift(int axis, int sign) const {
        return axis == 0 ? Shift{0, sign} : Shift{sign * std::ptrdiff_t(step(axis) / 64), 0};
    }

    bool has(Corner c, CellAxes axes) const { return word(c / 64, axes) >> (c % 64) & 1u; }
    Word word(std::size_t w, CellAxes axes) const { return cells_[w + 1].of[axes]; }
    /// Bit b tells whether the corner at `shift` from corner 64 w + b has the cell.
    Word word(std::size_t w, CellAxes axes, Shift shift) const {
        return shifted([&](std::size_t at) { return word(at, axes); }, w, shift);
    }
    /// The same for any set of corners: wordAt(w) holds its bits of word w.
    template <class WordAt>
    static Word shifted(const WordAt& wordAt, std::size_t w, Shift shift) {
        const std::size_t at = w + std::size_t(shift.words);
        if (shift.bits > 0) return wordAt(at) >> 1 | wordAt(at + 1) << 63;
        if (shift.bits < 0) return wordAt(at) << 1 | wordAt(at - 1) >> 63;
        return wordAt(at);
    }

    /// Prefetches the cells of a word.
    void prefetch(std::size_t w) const { __builtin_prefetch(&cells_[w + 1]); }

    void remove(Corner c, CellAxes axes) { remove(c / 64, axes, Word(1) << c % 64); }
    /// Removes the cells of all corners in `corners`. Safe from many threads at once.
    void remove(std::size_t w, CellAxes axes, Word corners) {
        std::atomic_ref(cells_[w + 1].of[axes]).fetch_and(~corners, std::memory_order_relaxed);
    }

    /// Largest of `values` over the cubes around the cell; values[c] belongs to the cube at corner
    /// c.
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

    /// Euler characteristic: points - edges + squares - cubes.
    std::int64_t euler() const;
    std::size_t count(int dimension) const;

  private:
    /// The cells of one word, by axes: one cache line.
    struct alignas(64) Cells {
        std::array<Word, 8> of{};
    };

    std::array<std::size_t, 3> step_;
    // By word, with one more before the first: a shift from the first cell may reach it.
    std::vector<Cells> cells_;
};

}  // namespace lacuna
