// The skeleton as a graph, and its reduction to few nodes with large balls.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "libcore/skeleton/thinning.h"

namespace lacuna {

struct SkeletonNode {
    Vec3d position;     ///< recentred coordinates
    double radius = 0;  ///< of the largest ball about it that no surface enters
};

/// Everything that thinning left: a node per point, an edge per edge.
struct SkeletonGraph {
    std::vector<SkeletonNode> nodes;
    std::vector<std::array<std::uint32_t, 2>> edges;

    std::int64_t b0() const;
    std::int64_t b1() const {
        return std::int64_t(edges.size()) - std::int64_t(nodes.size()) + b0();
    }
};

/// `radiusAt` gives the exact distance to the surface; called from many threads.
SkeletonGraph extractGraph(const CubicalComplex& complex, const VoxelShape& shape,
                           const std::function<double(const Vec3d&)>& radiusAt,
                           const ThreadPool& pool);

/// An edge of the filtered graph: from the first node straight to `leave`, along an edge of the raw
/// graph to `enter`, straight to the second. Both straight pieces lie in their node's ball, so all
/// of it lies in empty space.
struct FilteredEdge {
    std::array<std::uint32_t, 2> nodes;
    Vec3d leave, enter;
};

/// A multigraph: parallel edges and loops at one node stay.
struct FilteredGraph {
    std::vector<SkeletonNode> nodes;
    std::vector<FilteredEdge> edges;
    std::int64_t b0() const;
    std::int64_t b1() const {
        return std::int64_t(edges.size()) - std::int64_t(nodes.size()) + b0();
    }
};

/// The maximal-ball filter [Noel15 4.4]: by falling radius (ties: lower index first) a node that is
/// still there is kept and swallows the nodes inside its ball that are connected to it there, also
/// through nodes that an earlier one has swallowed. Unlike in the paper, connected is asked for:
/// two branches that meet in a ball but are joined outside of it would become a loop.
///
/// A swallowed node is reached by one edge, from a node that the same ball or an earlier one has
/// swallowed. These edges make a forest of one tree per kept node. They are left out, and every
/// other edge joins the nodes that swallowed its ends: b0 and b1 are those of `graph`. And as an
/// edge that is left out lies in the ball that reached along it, the loops are the same ones.
FilteredGraph filterByMaximalBalls(const SkeletonGraph& graph);

}  // namespace lacuna
