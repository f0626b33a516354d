// Compares the node map with brute force, and checks which node a point on a surface is mapped to.
#include "libcore/skeleton/node_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/voxel/voxelize.h"
#include "tests/fixtures/never.h"
#include "tests/skeleton/voxel_shapes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

/// Distance in voxels and nearest node of each voxel, by repeated relaxation in real numbers.
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
    // Coordinates are negative too: a lookup that truncates would merge two voxels.
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

/// The floor (y = 0) of two rooms with a wall of one voxel between them at x = 5. In the wall's
/// column, only the position within the voxel tells which room is nearer.
TEST(NodeMap, findsTheNearerRoomAtTheFootOfAWall) {
    const VoxelSpace space = drawn({11, 6, 5}, [](int x, int y, int) { return x == 5 || y == 0; });
    const std::vector<SkeletonNode> nodes = {{{2, 3, 2}, 1}, {{9, 3, 2}, 1}};
    const NodeMap map = mapNodes(space, nodes, ThreadPool(1), kNever);
    for (const double x : {5.1, 5.3, 5.45}) EXPECT_EQ(map.at({x, 0.9, 2.5}, {0, 1, 0}), 0) << x;
    for (const double x : {5.55, 5.7, 5.9}) EXPECT_EQ(map.at({x, 0.9, 2.5}, {0, 1, 0}), 1) << x;
}

TEST(NodeMap, goesThroughAThicketAndNoFarther) {
    // Empty space at x < 3 and x >= 8, and five solid voxels between.
    const VoxelSpace space = drawn({12, 5, 5}, [](int x, int, int) { return x >= 3 && x < 8; });
    const std::vector<SkeletonNode> nodes = {{{1, 2, 2}, 1}, {{10, 2, 2}, 1}};
    const NodeMap map = mapNodes(space, nodes, ThreadPool(1), kNever);
    EXPECT_EQ(map.at({5.2, 2.5, 2.5}, {1, 0, 0}), 1) << "at 3 voxels";
    EXPECT_EQ(map.at({5.2, 2.5, 2.5}, {-1, 0, 0}), 0) << "at 2.5";
    EXPECT_EQ(map.at({4.9, 2.5, 2.5}, {1, 0, 0}), NodeMap::kNone) << "at 3.1";
    EXPECT_EQ(map.at({3.2, 2.5, 2.5}, {1, 0, 0}), 0) << "what its voxel took over";
    // Outside the grid, but in front of it.
    EXPECT_EQ(map.at({-0.3, 2.5, 2.5}, {1, 0, 0}), 0);
    EXPECT_EQ(map.at({-0.3, 2.5, 2.5}, {-1, 0, 0}), NodeMap::kNone);
}

Vec3d randomUnit(Rng& rng) {
    for (;;) {
        const Vec3d v{2 * rng.uniformDouble() - 1, 2 * rng.uniformDouble() - 1,
                      2 * rng.uniformDouble() - 1};
        if (lengthSquared(v) < 1 && lengthSquared(v) > 0.01) return normalize(v);
    }
}

/// Walls that pass straight through a cube of 22^3 voxels around the origin. Each is the space
/// between two planes, and its normal points from the first to the second. The walls divide the
/// cube into rooms.
class Walls {
  public:
    static constexpr int kSide = 22;
    struct Wall {
        Vec3d normal;
        double at, thickness;
    };

    explicit Walls(std::vector<Wall> walls) : walls_(std::move(walls)) {
        std::vector<Triangle> triangles;
        for (const Wall& w : walls_) {
            addSheet(w.normal, w.at, triangles);
            if (w.thickness > 0) addSheet(w.normal, w.at + w.thickness, triangles);
        }
        const double h = 0.5 * kSide;
        space_.shape = latticeExactlyOver({{-h, -h, -h}, {h, h, h}}, kSide);
        space_.state.assign(space_.shape.count(), VoxelState::Empty);
        voxelize(triangles, space_.shape, space_.state, ThreadPool(1), kNever);
        addNodes();
    }

    /// The room on one side of a point on wall `own`, as one bit per wall; -1 inside another wall.
    int roomAt(const Vec3d& p, std::size_t own, bool beyond) const {
        int room = 0;
        for (std::size_t w = 0; w < walls_.size(); ++w) {
            const double d = dot(p, walls_[w].normal) - walls_[w].at;
            if (w != own && d > 0 && d < walls_[w].thickness) return -1;
            room |= int(w == own ? beyond : d > 0) << w;
        }
        return room;
    }
    /// The room of a node; -1 if there is no such node.
    int roomOf(std::uint16_t node) const {
        return node < nodes_.size() ? roomAt(nodes_[node].position, walls_.size(), false) : -1;
    }
    /// Whether one of the 27 voxels around the point is empty and belongs to that room.
    bool hasVoxelNear(const Vec3d& p, int room) const {
        const VoxelIndex v = space_.shape.voxelOf(p);
        for (int n = 0; n < 27; ++n) {
            const VoxelIndex u{v[0] + n % 3 - 1, v[1] + n / 3 % 3 - 1, v[2] + n / 9 - 1};
            if (space_.empty(u) && roomAt(space_.shape.centre(u), walls_.size(), false) == room)
                return true;
        }
        return false;
    }
    /// A point on a face of the wall, not near the grid's border.
    bool samplePoint(Rng& rng, std::size_t wall, bool beyond, Vec3d& p) const {
        const auto coordinate = [&] { return (kSide - 4) * (rng.uniformDouble() - 0.5); };
        const Vec3d q{coordinate(), coordinate(), coordinate()};
        const Wall& w = walls_[wall];
        p = q - w.normal * (dot(q, w.normal) - w.at - (beyond ? w.thickness : 0.0));
        return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) < 0.5 * kSide - 2;
    }
    const Wall& wall(std::size_t i) const { return walls_[i]; }
    const NodeMap& map() const { return map_; }

  private:
    static void addSheet(const Vec3d& n, double at, std::vector<Triangle>& triangles) {
        const Vec3d u = normalize(cross(n, std::fabs(n.x) < 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
        const Vec3d v = cross(n, u);
        const auto corner = [&](double a, double b) {
            return Vec3(n * at + (u * a + v * b) * (3.0 * kSide));
        };
        triangles.push_back({corner(1, 1), corner(-1, 1), corner(-1, -1)});
        triangles.push_back({corner(1, 1), corner(-1, -1), corner(1, -1)});
    }
    /// Adds a node to every room that has voxels, at the first of them.
    void addNodes() {
        std::vector<bool> has(std::size_t(1) << walls_.size(), false);
        for (std::size_t i = 0; i < space_.state.size(); ++i) {
            if (space_.state[i] != VoxelState::Empty) continue;
            const Vec3d centre = space_.shape.centre(space_.shape.indexOf(i));
            const int room = roomAt(centre, walls_.size(), false);
            if (room < 0 || has[std::size_t(room)]) continue;
            has[std::size_t(room)] = true;
            nodes_.push_back({centre, 1});
        }
        map_ = mapNodes(space_, nodes_, ThreadPool(1), kNever);
    }

    std::vector<Wall> walls_;
    VoxelSpace space_;
    std::vector<SkeletonNode> nodes_;
    NodeMap map_;
};

/// One wall, thinner than a voxel or a single sheet. The map never returns a node on the other
/// side.
TEST(NodeMap, keepsToTheSideOfASlantedWall) {
    std::size_t points = 0, wrong = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Rng rng(seed, 3, StreamKind::User, 0);
        Vec3d normal = randomUnit(rng);
        if (seed % 4 == 0) normal[rng.below(3)] = 0;  // parallel to an axis
        const double thickness = seed % 3 == 0 ? 0.0 : 0.9 * rng.uniformDouble();
        const Walls walls({{normalize(normal), 8 * rng.uniformDouble() - 4, thickness}});
        for (int i = 0; i < 200; ++i) {
            const bool beyond = i % 2 == 0;
            Vec3d p;
            if (!walls.samplePoint(rng, 0, beyond, p)) continue;
            const Vec3d side = walls.wall(0).normal * (beyond ? 1.0 : -1.0);
            ++points;
            wrong += walls.roomOf(walls.map().at(p, side)) != int(beyond);
        }
    }
    EXPECT_GT(points, 5000u);
    EXPECT_EQ(wrong, 0u);
    stabilityCase("node-sides", double(wrong), "points on the other side");
}

/// Two or three walls intersect at any angle. In the wedges between them, a room's voxels end
/// before the room does. If a voxel of the room is around a point, the map finds the room's node,
/// except for a few points whose voxel holds two walls.
TEST(NodeMap, hardlyEverLeavesTheRoomInAWedge) {
    std::size_t points = 0, wrong = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Rng rng(seed, 4, StreamKind::User, 0);
        std::vector<Walls::Wall> made(2 + seed % 2);
        for (Walls::Wall& w : made) {
            w = {randomUnit(rng), 6 * rng.uniformDouble() - 3, seed % 3 == 0 ? 0.3 : 0.0};
        }
        const Walls walls(made);
        for (int i = 0; i < 400; ++i) {
            const std::size_t own = rng.below(std::uint32_t(made.size()));
            const bool beyond = i % 2 == 0;
            Vec3d p;
            if (!walls.samplePoint(rng, own, beyond, p)) continue;
            const int room = walls.roomAt(p, own, beyond);
            if (room < 0 || !walls.hasVoxelNear(p, room)) continue;
            ++points;
            const Vec3d side = made[own].normal * (beyond ? 1.0 : -1.0);
            wrong += walls.roomOf(walls.map().at(p, side)) != room;
        }
    }
    EXPECT_GT(points, 8000u);
    const double share = double(wrong) / double(points);
    EXPECT_LT(share, 0.012);
    stabilityCase("node-wedges", 100 * share, "% of points in another room");
}

}  // namespace
}  // namespace lacuna::test
