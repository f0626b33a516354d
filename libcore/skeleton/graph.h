// The skeleton as a graph, and its reduction to a few nodes with large balls.
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
    double radius = 0;  ///< of the largest ball around it that no surface enters
};

/// Everything that thinning left: one node per point, one edge per edge of the complex.
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

/// An edge of the filtered graph. It goes straight from the first node to `leave`, along an edge of
/// the raw graph to `enter`, and straight to the second node. Both straight pieces lie in their
/// node's ball, so that the whole edge lies in empty space.
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

/// The maximal-ball filter [Noel15 4.4]. It visits nodes by decreasing radius (ties: lower index
/// first). A node that no other has swallowed is kept. It swallows those nodes inside its ball that
/// are connected to it there, also through nodes that an earlier one has swallowed. Unlike in the
/// paper, they must be connected: otherwise two branches that enter one ball but are joined outside
/// of it would become a loop.
///
/// One edge reaches each swallowed node, from a node that the same ball or an earlier one has
/// swallowed. These edges form a forest with one tree per kept node, and are left out. Every other
/// edge joins the nodes that swallowed its ends. Hence b0 and b1 are those of `graph`. An edge that
/// is left out lies in the ball that reached along it, so that the loops are the same as well.
FilteredGraph filterByMaximalBalls(const SkeletonGraph& graph);

}  // namespace lacuna
