// The maximal-ball filter on any kind of graph: which nodes it removes and which it keeps. b0 and
// b1 stay the same.
#include "libcore/skeleton/graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "libcore/base/rng.h"
#include "libcore/voxel/voxelize.h"
#include "tests/skeleton/voxel_shapes.h"

namespace lacuna::test {
namespace {

using Edges = std::vector<std::array<std::uint32_t, 2>>;

bool inBall(const Vec3d& p, const SkeletonNode& ball) {
    return length(p - ball.position) < ball.radius;
}

/// The raw nodes that are connected to a node within its ball, including the node itself.
std::vector<bool> connectedInBall(const SkeletonGraph& graph, std::size_t node) {
    std::vector<bool> reached(graph.nodes.size(), false);
    reached[node] = true;
    for (bool changed = true; changed;) {
        changed = false;
        for (const auto& [a, b] : graph.edges) {
            for (const auto& [from, to] : {std::pair{a, b}, {b, a}}) {
                if (!reached[from] || reached[to]) continue;
                if (!inBall(graph.nodes[to].position, graph.nodes[node])) continue;
                reached[to] = changed = true;
            }
        }
    }
    return reached;
}

/// The rule, literally: nodes by falling radius, equal ones by index.
std::vector<std::size_t> keptNodes(const SkeletonGraph& graph) {
    std::vector<std::size_t> order(graph.nodes.size()), kept;
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return graph.nodes[a].radius > graph.nodes[b].radius;
    });
    std::vector<bool> swallowed(order.size(), false);
    for (const std::size_t k : order) {
        if (swallowed[k]) continue;
        kept.push_back(k);
        const std::vector<bool> reached = connectedInBall(graph, k);
        for (std::size_t i = 0; i < reached.size(); ++i) swallowed[i] = swallowed[i] || reached[i];
    }
    return kept;
}

void expectFiltered(const SkeletonGraph& graph, const std::string& what) {
    const FilteredGraph filtered = filterByMaximalBalls(graph);
    EXPECT_EQ(filtered.b0(), graph.b0()) << what;
    EXPECT_EQ(filtered.b1(), graph.b1()) << what;
    const std::vector<std::size_t> kept = keptNodes(graph);
    ASSERT_EQ(filtered.nodes.size(), kept.size()) << what;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        EXPECT_EQ(filtered.nodes[i].position, graph.nodes[kept[i]].position) << what;
        EXPECT_EQ(filtered.nodes[i].radius, graph.nodes[kept[i]].radius) << what;
    }
    for (const FilteredEdge& e : filtered.edges) {
        const SkeletonNode &from = filtered.nodes[e.nodes[0]], &to = filtered.nodes[e.nodes[1]];
        EXPECT_TRUE(e.leave == from.position || inBall(e.leave, from)) << what;
        EXPECT_TRUE(e.enter == to.position || inBall(e.enter, to)) << what;
        const bool raw = std::ranges::any_of(graph.edges, [&](const auto& r) {
            return graph.nodes[r[0]].position == e.leave && graph.nodes[r[1]].position == e.enter;
        });
        EXPECT_TRUE(raw) << what;
    }
}

/// The large ball at j holds m. The smaller one at k also holds m, and y behind it.
SkeletonGraph behindAnOwnedNode(const Edges& edges) {
    const SkeletonNode j{{0, 0, 0}, 2.2}, m{{2, 0, 0}, 1.5}, k{{2, 1.5, 0}, 2}, y{{3, -0.2, 0}, 1};
    return {{j, m, k, y}, edges};
}

TEST(MaximalBalls, reachThroughNodesOfOthers) {
    const SkeletonGraph tree = behindAnOwnedNode({{0, 1}, {1, 2}, {1, 3}});
    expectFiltered(tree, "tree");
    const FilteredGraph filtered = filterByMaximalBalls(tree);
    ASSERT_EQ(filtered.nodes.size(), 2u) << "y lies in the ball of k, connected to it through m";
    ASSERT_EQ(filtered.edges.size(), 1u);
    EXPECT_EQ(filtered.edges[0].nodes, (std::array<std::uint32_t, 2>{0, 1}));
    EXPECT_EQ(filtered.edges[0].leave, tree.nodes[1].position);
    EXPECT_EQ(filtered.edges[0].enter, tree.nodes[2].position);
    // With a second way from k to y there is a loop, which must stay.
    expectFiltered(behindAnOwnedNode({{0, 1}, {1, 2}, {1, 3}, {3, 2}}), "loop");
}

TEST(MaximalBalls, leaveWhatTheyHoldButDoNotReach) {
    // Two ends of a horseshoe lie in one ball, but the way between them leaves it.
    SkeletonGraph graph;
    for (const Vec3d& p :
         {Vec3d{0, 0, 0}, Vec3d{0, 3, 0}, Vec3d{1, 4, 0}, Vec3d{2, 3, 0}, Vec3d{1.2, 0, 0}}) {
        graph.nodes.push_back({p, 1});
    }
    graph.nodes[0].radius = 1.5;
    graph.edges = {{0, 1}, {1, 2}, {2, 3}, {3, 4}};
    expectFiltered(graph, "horseshoe");
    EXPECT_EQ(filterByMaximalBalls(graph).nodes.size(), 5u);
}

TEST(MaximalBalls, equalOnesByTheLowerIndex) {
    const SkeletonGraph pair{{{{0, 0, 0}, 2}, {{1, 0, 0}, 2}}, {{0, 1}}};
    const FilteredGraph filtered = filterByMaximalBalls(pair);
    ASSERT_EQ(filtered.nodes.size(), 1u);
    EXPECT_EQ(filtered.nodes[0].position, pair.nodes[0].position);
    // A node on the sphere is not inside.
    const SkeletonGraph apart{{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}}, {{0, 1}}};
    EXPECT_EQ(filterByMaximalBalls(apart).nodes.size(), 2u);
}

/// Nodes at random with balls of random size, and edges between any of them, including parallel
/// edges and loops.
TEST(MaximalBalls, keepComponentsAndLoopsOfAnyGraph) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Rng rng(seed, 2, StreamKind::User, 0);
        SkeletonGraph graph;
        const std::uint32_t nodes = 1 + rng.below(40), edges = rng.below(80);
        for (std::uint32_t n = 0; n < nodes; ++n) {
            const Vec3d p{rng.uniformDouble(), rng.uniformDouble(), rng.uniformDouble()};
            // Few different sizes, so that some are equal.
            graph.nodes.push_back({p * 4.0, 0.5 * double(rng.below(6))});
        }
        for (std::uint32_t e = 0; e < edges; ++e) {
            graph.edges.push_back({rng.below(nodes), rng.below(nodes)});
        }
        expectFiltered(graph, "seed " + std::to_string(seed));
    }
}

}  // namespace
}  // namespace lacuna::test
