// Thinning: collapses the empty space to curves that keep its components and loops.
//
// An elementary collapse removes a cell together with a face that belongs to no other cell. It
// never changes the homotopy type. As in [Chaussard13], a round goes through the directions -x, +x,
// .. +z. In each it removes all free pairs (cube, square) at once, then (square, edge), then (edge,
// point). The free pairs of one direction and dimension do not touch each other, so that a step is
// parallel and its result does not depend on the order. Unlike [Chaussard13],
//
//   * a round removes layers by Euclidean distance: in round r, only cells within r voxels of the
//     surface may be removed. The result is therefore centred between walls of any direction;
//   * an edge becomes the end of a branch, and stays, once it has outlived the last square at it by
//     more rounds than the opening there. The opening is the half width in voxels of the largest
//     cube of empty voxels that contains the place: a bump that sticks out of a ball by less than
//     the ball's radius makes no branch. [Chaussard13] add the round in which the edge appeared and
//     subtract the distance; the two are about equal;
//   * a solid that floats in the empty space (a cavity, b2 > 0) is wrapped in a sheet of squares
//     that no collapse can remove. One square of each sheet is removed, the one nearest to a
//     surface, and the collapse goes on. This opens the cavity and changes nothing else: the square
//     separates two regions of the complement, so it lies on a closed surface, and b0 and b1 stay.
//     It is as if the floating solid were hung on a thread from its nearest neighbour.
//
// The outside of the grid is solid, so that open scenes have a skeleton.
#pragma once

#include "libcore/skeleton/cubical_complex.h"

namespace lacuna {

class ThreadPool;

struct Thinned {
    CubicalComplex complex;  ///< only points and edges, except for `squares`
    std::size_t rounds = 0;
    std::size_t punctures = 0;  ///< squares removed from sheets: one per cavity
    /// Squares that could not be collapsed but separate no two regions. Each adds to the graph at
    /// most one loop that the empty space does not have. No such square has been seen.
    std::size_t squares = 0;
};

/// Throws InterruptedError once `cancel` is set.
Thinned thin(const VoxelSpace& space, const ThreadPool& pool, const std::atomic<bool>& cancel);

/// Per voxel: half width, in voxels, of the largest cube of Empty voxels that contains it (1: the
/// voxel alone); 0 where it is not Empty.
std::vector<std::uint16_t> openingMap(const VoxelSpace& space, const ThreadPool& pool);

}  // namespace lacuna
