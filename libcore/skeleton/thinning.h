// Thinning: the empty space collapsed to curves that keep its components and loops.
//
// An elementary collapse removes a cell together with a face that belongs to no other cell; it
// never changes the homotopy type. As in [Chaussard13] a round goes through the directions -x, +x,
// .. +z and removes, in each, all free pairs (cube, square), then (square, edge), then (edge,
// point) at once: the free pairs of one direction and dimension do not touch each other, so a round
// is parallel and its result does not depend on the order. Differently from there
//
//   * a round takes layers by Euclidean distance: in round r only cells within r voxels of the
//     surface may go, so that what is left is centred for walls of any direction;
//   * an edge becomes the end of a branch, and stays, once it has outlived the last square at it by
//     as many rounds as the opening there, the half width in voxels of the largest cube of empty
//     voxels that holds the place: what sticks out of a ball by less than its radius is no branch.
//     [Chaussard13] add the round in which the edge appeared and subtract the distance; the two are
//     about equal;
//   * a solid that floats in the empty space (a cavity, b2 > 0) is wrapped in a sheet of squares
//     that no collapse can remove. One square of each sheet is taken out, where it is nearest to a
//     surface: that removes the cavity and nothing else (the square parts two regions of the
//     complement, so it lies on a closed surface, and b0 and b1 stay), and the collapse goes on.
//     It is as if the floating solid were hung on a thread from its nearest neighbour.
//
// The outside of the grid is solid, so that open scenes have a skeleton.
#pragma once

#include "libcore/skeleton/cubical_complex.h"

namespace lacuna {

class ThreadPool;

struct Thinned {
    CubicalComplex complex;  ///< points and edges alone, but for `squares`
    std::size_t rounds = 0;
    std::size_t punctures = 0;  ///< squares taken out of sheets: the cavities
    /// Squares that could not be collapsed and part no two regions. Each adds at most one loop to
    /// the graph that is not in the empty space; none has been seen.
    std::size_t squares = 0;
};

/// Throws Error 130 once `cancel` is set.
Thinned thin(const VoxelSpace& space, const ThreadPool& pool, const std::atomic<bool>& cancel);

/// Per voxel: half width of the largest cube of Empty voxels that holds it, in voxels (1: the voxel
/// alone); 0 where it is not Empty.
std::vector<std::uint16_t> openingMap(const VoxelSpace& space, const ThreadPool& pool);

}  // namespace lacuna
