// The node map against Dijkstra's algorithm, and what a point on a surface is mapped to.
#include "libcore/skeleton/node_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "tests/skeleton/voxel_shapes.h"

namespace lacuna::test {
namespace {

const std::atomic<bool> kNever{false};

/// Distance in voxels and node, by repeated relaxation in real numbers.
std::vector<std::pair<double, int>> bruteForce(const VoxelSpace& space,
                                               const std::vector<SkeletonNode>& nodes) {
    std::vector<std::pair<double, int>> best(space.state.size(), {1e9, -1});
    for (std::size_t n = nodes.size(); n-- > 0;) {
        for (std::size_t i = 0; i < best.size(); ++i) {
            const Vec3d away = space.shape.centre(space.shape.indexOf(i)) - nodes[n].position;
            const bool around =
                std::fabs(away.x) < 0.6 && std::fabs(away.y) < 0.6 && std::fabs(away.z) < 0.6;
            if (around && space.state[i] == VoxelState::Empty) best[i] = {0.0, int(n)};
        }
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < best.size(); ++i) {
            if (space.state[i] != VoxelState::Empty || best[i].second < 0) continue;
            const VoxelIndex v = space.shape.indexOf(i);
            for (int n = 0; n < 27; ++n) {
                const VoxelIndex u{v[0] + n % 3 - 1, v[1] + n / 3 % 3 - 1, v[2] + n / 9 - 1};
                if (!space.empty(u)) continue;
                const double d =
                    best[i].first + std::sqrt((n % 3 != 1) + (n / 3 % 3 != 1) + (n / 9 != 1));
                auto& other = best[space.shape.at(u)];
                if (d < other.first - 1e-3 ||
                    (d < other.first + 1e-3 && best[i].second < other.second)) {
                    other = {std::min(d, other.first), best[i].second};
                    changed = true;
                }
            }
        }
    }
    return best;
}

TEST(NodeMap, meetsBruteForce) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const VoxelSpace space = randomSpace({9, 8, 10}, 0.1 + 0.03 * double(seed), seed);
        Rng rng(seed, 1, StreamKind::User, 0);
        std::vector<SkeletonNode> nodes;
        for (int n = 0; n < 6; ++n) {
            nodes.push_back(
                {Vec3d{double(rng.below(10)), double(rng.below(9)), double(rng.below(11))}, 1});
        }
        const auto expected = bruteForce(space, nodes);
        for (const int threads : {1, 2, 7}) {
            const ThreadPool pool(threads);
            const NodeMap map = mapNodes(space, nodes, pool, kNever);
            for (std::size_t i = 0; i < expected.size(); ++i) {
                if (space.state[i] != VoxelState::Empty) {
                    EXPECT_TRUE(map.entries()[i] & NodeMap::kSolid);
                    continue;
                }
                EXPECT_EQ(map.entries()[i],
                          expected[i].second < 0 ? NodeMap::kNone : expected[i].second)
                    << "seed " << seed << " voxel " << i;
            }
        }
    }
}

TEST(NodeMap, tellsTheSidesOfAThinWallApart) {
    // Negative coordinates: a lookup that truncates would fold two voxels into one.
    const VoxelSpace space =
        drawn({11, 5, 5}, [](int x, int, int) { return x == 5; }, {-5.5, -2.5, -2.5});
    const std::vector<SkeletonNode> nodes = {{{-3.5, -0.5, -0.5}, 1}, {{3.5, -0.5, -0.5}, 1}};
    const ThreadPool pool(1);
    const NodeMap map = mapNodes(space, nodes, pool, kNever);
    for (const double x : {-0.4, 0.0, 0.4}) {
        EXPECT_EQ(map.at({x, 0.2, 0.3}, {-1, 0, 0}), 0) << x;
        EXPECT_EQ(map.at({x, 0.2, 0.3}, {1, 0, 0}), 1) << x;
    }
    EXPECT_EQ(map.at({-0.6, 0.2, 0.3}, {0, 1, 0}), 0);
    EXPECT_EQ(map.at({0.0, 0.2, 0.3}, {0, 1, 0}), 0) << "extended into the wall";
    EXPECT_EQ(map.at({30, 0, 0}, {0, 1, 0}), NodeMap::kNone);
    EXPECT_EQ(NodeMap().at({0, 0, 0}, {0, 1, 0}), NodeMap::kNone);
}

TEST(NodeMap, everyEmptyVoxelOfAPartWithANodeIsMapped) {
    const VoxelSpace space = drawn({12, 6, 6}, [](int x, int, int) { return x == 6; });
    const std::vector<SkeletonNode> nodes = {{{3, 3, 3}, 1}};
    const ThreadPool pool(1);
    const NodeMap map = mapNodes(space, nodes, pool, kNever);
    for (std::size_t i = 0; i < space.state.size(); ++i) {
        const int x = space.shape.indexOf(i)[0];
        if (x == 6) continue;
        EXPECT_EQ(map.entries()[i], x < 6 ? 0 : NodeMap::kNone) << i;
    }
}

}  // namespace
}  // namespace lacuna::test
