#include "libcore/skeleton/graph.h"

#include <algorithm>
#include <numeric>

#include "libcore/base/parallel.h"
#include "libcore/base/union_find.h"

namespace lacuna {

namespace {

constexpr std::uint32_t kNobody = 0xffffffffu;

/// An edge, as seen from one of its ends.
struct Way {
    std::uint32_t to, edge;
};

std::vector<std::vector<Way>> waysOf(const SkeletonGraph& graph) {
    std::vector<std::vector<Way>> ways(graph.nodes.size());
    for (std::uint32_t i = 0; i < graph.edges.size(); ++i) {
        const auto& e = graph.edges[i];
        ways[e[0]].push_back({e[1], i});
        ways[e[1]].push_back({e[0], i});
    }
    return ways;
}

std::vector<std::uint32_t> byFallingRadius(std::span<const SkeletonNode> nodes) {
    std::vector<std::uint32_t> order(nodes.size());
    std::iota(order.begin(), order.end(), std::uint32_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return nodes[a].radius > nodes[b].radius;
    });
    return order;
}

}  // namespace

std::int64_t SkeletonGraph::b0() const {
    UnionFind sets(nodes.size());
    for (const auto& e : edges) sets.join(e[0], e[1]);
    return std::int64_t(sets.sets());
}

std::int64_t FilteredGraph::b0() const {
    UnionFind sets(nodes.size());
    for (const FilteredEdge& e : edges) sets.join(e.nodes[0], e.nodes[1]);
    return std::int64_t(sets.sets());
}

SkeletonGraph extractGraph(const CubicalComplex& complex, const VoxelShape& shape,
                           const std::function<double(const Vec3d&)>& radiusAt,
                           const ThreadPool& pool) {
    SkeletonGraph graph;
    std::vector<CubicalComplex::Corner> corners;
    for (CubicalComplex::Corner c = 0; c < complex.corners(); ++c) {
        if (complex.has(c, 0)) corners.push_back(c);
    }
    const auto numberOf = [&](CubicalComplex::Corner c) {
        return std::uint32_t(std::lower_bound(corners.begin(), corners.end(), c) - corners.begin());
    };
    graph.nodes.resize(corners.size());
    pool.forEach(corners.size(), [&](std::size_t i) {
        const Vec3d p = shape.corner(complex.indexOf(corners[i]));
        graph.nodes[i] = {p, radiusAt(p)};
    });
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
        for (int a = 0; a < 3; ++a) {
            if (complex.has(corners[i], 1u << a)) {
                graph.edges.push_back({i, numberOf(corners[i] + complex.step(a))});
            }
        }
    }
    return graph;
}

FilteredGraph filterByMaximalBalls(const SkeletonGraph& graph) {
    const std::size_t n = graph.nodes.size();
    const std::vector<std::vector<Way>> ways = waysOf(graph);
    FilteredGraph filtered;
    // By raw node, as indices into filtered.nodes: the node that swallowed it, and the last node
    // whose ball reached it.
    std::vector<std::uint32_t> keeper(n, kNobody), reached(n, kNobody);
    std::vector<bool> leftOut(graph.edges.size(), false);
    std::vector<std::uint32_t> stack;
    for (const std::uint32_t k : byFallingRadius(graph.nodes)) {
        if (keeper[k] != kNobody) continue;
        const SkeletonNode& ball = graph.nodes[k];
        const auto number = std::uint32_t(filtered.nodes.size());
        filtered.nodes.push_back(ball);
        keeper[k] = reached[k] = number;
        stack.push_back(k);
        while (!stack.empty()) {
            const std::uint32_t here = stack.back();
            stack.pop_back();
            for (const Way& way : ways[here]) {
                if (reached[way.to] == number ||
                    !(length(graph.nodes[way.to].position - ball.position) < ball.radius)) {
                    continue;
                }
                reached[way.to] = number;
                stack.push_back(way.to);
                if (keeper[way.to] != kNobody) continue;  // an earlier ball swallowed it
                keeper[way.to] = number;
                leftOut[way.edge] = true;
            }
        }
    }
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
        if (leftOut[i]) continue;
        const auto& e = graph.edges[i];
        filtered.edges.push_back(
            {{keeper[e[0]], keeper[e[1]]}, graph.nodes[e[0]].position, graph.nodes[e[1]].position});
    }
    return filtered;
}

}  // namespace lacuna
