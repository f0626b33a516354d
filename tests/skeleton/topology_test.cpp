// Components, loops and cavities of known shapes. For every shape, the skeleton and the filtered
// graph have the same components and loops as the empty space.
#include "libcore/skeleton/topology.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/skeleton/graph.h"
#include "tests/fixtures/never.h"
#include "tests/skeleton/voxel_shapes.h"

namespace lacuna::test {
namespace {

struct Graphs {
    Thinned thinned;
    SkeletonGraph raw;
    FilteredGraph filtered;
};

Graphs skeletonOf(const VoxelSpace& space, int threads = 2) {
    const ThreadPool pool(threads);
    Graphs g{thin(space, pool, kNever), {}, {}};
    g.raw = extractGraph(
        g.thinned.complex, space.shape, [&](const Vec3d& p) { return distanceToSolid(space, p); },
        pool);
    g.filtered = filterByMaximalBalls(g.raw);
    return g;
}

/// Whether the point lies in a closed Empty voxel.
bool inEmptySpace(const VoxelSpace& space, const Vec3d& p) {
    for (int n = 0; n < 8; ++n) {
        const Vec3d shift{n & 1 ? 1e-7 : -1e-7, n & 2 ? 1e-7 : -1e-7, n & 4 ? 1e-7 : -1e-7};
        if (space.empty(space.shape.voxelOf(p + shift))) return true;
    }
    return false;
}

void expectInside(const VoxelSpace& space, const Vec3d& a, const Vec3d& b) {
    for (int i = 0; i <= 32; ++i) {
        const Vec3d p = a + (b - a) * (i / 32.0);
        ASSERT_TRUE(inEmptySpace(space, p)) << p.x << " " << p.y << " " << p.z;
    }
}

void expectSkeleton(const VoxelSpace& space, const Betti& expected, const std::string& what) {
    const Betti empty = emptySpaceBetti(space);
    EXPECT_EQ(empty.b0, expected.b0) << what;
    EXPECT_EQ(empty.b1, expected.b1) << what;
    EXPECT_EQ(empty.b2, expected.b2) << what;
    const Graphs g = skeletonOf(space);
    EXPECT_EQ(g.thinned.squares, 0u) << what;
    EXPECT_EQ(g.thinned.complex.count(3), 0u) << what;
    EXPECT_EQ(std::int64_t(g.thinned.punctures), expected.b2) << what;
    EXPECT_EQ(g.raw.b0(), expected.b0) << what;
    EXPECT_EQ(g.raw.b1(), expected.b1) << what;
    EXPECT_EQ(g.filtered.b0(), expected.b0) << what;
    EXPECT_EQ(g.filtered.b1(), expected.b1) << what;
    EXPECT_LE(g.filtered.nodes.size(), g.raw.nodes.size()) << what;
    for (const auto& e : g.raw.edges) {
        expectInside(space, g.raw.nodes[e[0]].position, g.raw.nodes[e[1]].position);
    }
    for (const FilteredEdge& e : g.filtered.edges) {
        expectInside(space, g.filtered.nodes[e.nodes[0]].position, e.leave);
        expectInside(space, e.leave, e.enter);
        expectInside(space, e.enter, g.filtered.nodes[e.nodes[1]].position);
    }
}

/// Distance from the middle of a grid of 18^3 voxels.
double fromMiddle(int x, int y, int z) {
    return std::sqrt((x - 8.5) * (x - 8.5) + (y - 8.5) * (y - 8.5) + (z - 8.5) * (z - 8.5));
}

/// Whether (x, y) lies in a ring about (cx, cy).
bool inRing(double x, double y, double cx, double cy, double inner, double outer) {
    const double r = std::hypot(x - cx, y - cy);
    return r >= inner && r < outer;
}

TEST(Topology, emptyBox) {
    expectSkeleton(drawn({9, 12, 15}, [](int, int, int) { return false; }), {1, 0, 0}, "box");
}

TEST(Topology, ball) {
    expectSkeleton(drawn({18, 18, 18}, [](int x, int y, int z) { return fromMiddle(x, y, z) > 7; }),
                   {1, 0, 0}, "ball");
}

TEST(Topology, torusTunnel) {
    const auto solid = [](int x, int y, int z) {
        return !(inRing(x, y, 9.5, 9.5, 4, 9) && z >= 1 && z <= 4);
    };
    expectSkeleton(drawn({20, 20, 6}, solid), {1, 1, 0}, "torus");
}

TEST(Topology, doubleTorus) {
    const auto solid = [](int x, int y, int z) {
        const bool ring = inRing(x, y, 8, 8, 3, 7.5) || inRing(x, y, 20, 8, 3, 7.5);
        return !(ring && z >= 1 && z <= 4);
    };
    expectSkeleton(drawn({29, 17, 6}, solid), {1, 2, 0}, "double torus");
}

TEST(Topology, hollowBallPartsTheSpace) {
    const auto solid = [](int x, int y, int z) {
        const double r = fromMiddle(x, y, z);
        return r > 5 && r < 7;
    };
    expectSkeleton(drawn({18, 18, 18}, solid), {2, 0, 1}, "hollow ball");
}

/// Two rooms with a wall of one voxel between them at x = 10, and this many doors.
VoxelSpace twoRooms(int doors) {
    return drawn({21, 15, 8}, [doors](int x, int y, int z) {
        if (x != 10) return false;
        const bool door =
            z < 5 && ((doors > 0 && y >= 2 && y <= 4) || (doors > 1 && y >= 9 && y <= 11));
        return !door;
    });
}

TEST(Topology, twoRooms) {
    expectSkeleton(twoRooms(0), {2, 0, 0}, "a wall of one voxel");
    expectSkeleton(twoRooms(1), {1, 0, 0}, "one door");
    expectSkeleton(twoRooms(2), {1, 1, 0}, "two doors");
}

TEST(Topology, slantedWallsOfOneVoxelDoNotLeak) {
    // The voxels that the plane x + y + z = 14.5 passes through.
    const auto slanted = [](int x, int y, int z) { return x + y + z <= 14 && x + y + z + 3 >= 15; };
    expectSkeleton(drawn({10, 10, 10}, slanted), {2, 0, 0}, "slanted wall");
    // Voxels of a thinner wall touch only along edges, and the space stays connected.
    const auto diagonal = [](int x, int y, int) { return x == y; };
    EXPECT_EQ(emptySpaceBetti(drawn({6, 6, 4}, diagonal)).b0, 1);
}

TEST(Topology, pillars) {
    const auto pillar = [](int x, int y, int) { return x >= 8 && x <= 9 && y >= 5 && y <= 6; };
    expectSkeleton(drawn({18, 12, 9}, pillar), {1, 1, 0}, "pillar");
    const auto row = [](int x, int y, int) { return x % 6 == 3 && y >= 5 && y <= 6; };
    expectSkeleton(drawn({24, 12, 9}, row), {1, 4, 0}, "row of pillars");
}

TEST(Topology, openHall) {
    // Floor and four walls without a roof: the outside of the grid closes the hall.
    const auto hall = [](int x, int y, int z) {
        return y == 0 || x == 0 || x == 15 || z == 0 || z == 23;
    };
    expectSkeleton(drawn({16, 12, 24}, hall), {1, 0, 0}, "open hall");
}

TEST(Topology, floatingSolids) {
    const auto lamp = [](int x, int y, int z) {
        return x >= 6 && x <= 8 && y >= 9 && y <= 10 && z >= 6 && z <= 8;
    };
    expectSkeleton(drawn({15, 14, 15}, lamp), {1, 0, 1}, "lamp");
    const auto many = [](int x, int y, int z) { return x % 6 == 3 && y % 5 == 2 && z % 7 == 3; };
    expectSkeleton(drawn({18, 10, 14}, many), {1, 0, 12}, "twelve crumbs");
    // A floating ring makes a cavity around it and a loop through it.
    const auto ring = [](int x, int y, int z) {
        return z >= 5 && z <= 6 && inRing(x, y, 9.5, 9.5, 3, 5.5);
    };
    expectSkeleton(drawn({20, 20, 12}, ring), {1, 1, 1}, "floating ring");
    // A ball within a hollow ball: each makes a cavity.
    const auto nested = [](int x, int y, int z) {
        const double r = fromMiddle(x, y, z);
        return r < 1.5 || (r > 5 && r < 7);
    };
    expectSkeleton(drawn({18, 18, 18}, nested), {2, 0, 2}, "ball in a ball");
}

TEST(Topology, corridorLoops) {
    // Streets along every sixth line: a grid of 4 x 3 blocks.
    const auto blocks = [](int x, int y, int z) {
        return z == 0 || z == 4 || !(x % 6 < 2 || y % 6 < 2);
    };
    expectSkeleton(drawn({26, 20, 5}, blocks), {1, 12, 0}, "streets");
}

TEST(Topology, deadEndRoomsHaveABranch) {
    // A hall with three long side chapels: there is no loop, and thinning alone would leave one
    // point.
    const auto solid = [](int x, int y, int z) {
        const bool hall = y < 6, chapel = x % 10 >= 2 && x % 10 <= 6;
        return z == 0 || z == 6 || !(hall || chapel);
    };
    const VoxelSpace space = drawn({30, 26, 7}, solid);
    expectSkeleton(space, {1, 0, 0}, "chapels");
    const Graphs g = skeletonOf(space);
    for (const int chapel : {4, 14, 24}) {
        bool reached = false;
        for (const SkeletonNode& n : g.raw.nodes) {
            reached |= std::fabs(n.position.x - chapel - 0.5) < 3 && n.position.y > 18;
        }
        EXPECT_TRUE(reached) << "chapel at " << chapel;
    }
}

bool inMenger(int x, int y, int z) {
    while (x > 0 || y > 0 || z > 0) {
        if (int(x % 3 == 1) + int(y % 3 == 1) + int(z % 3 == 1) >= 2) return false;
        x /= 3;
        y /= 3;
        z /= 3;
    }
    return true;
}

TEST(Topology, mengerSponge) {
    // As empty space, the sponges have 5 and 81 loops. The last shape is the tunnels of sponge 1
    // alone: the outside of the grid is solid.
    expectSkeleton(drawn({3, 3, 3}, [](int x, int y, int z) { return !inMenger(x, y, z); }),
                   {1, 5, 0}, "sponge 1");
    expectSkeleton(drawn({9, 9, 9}, [](int x, int y, int z) { return !inMenger(x, y, z); }),
                   {1, 81, 0}, "sponge 2");
    expectSkeleton(
        drawn({9, 9, 9}, [](int x, int y, int z) { return inMenger(x / 3, y / 3, z / 3); }),
        {1, 0, 0}, "cross");
}

/// Rank over GF(2) of a matrix given by its columns' sets of rows.
std::size_t rankOf(std::vector<std::vector<std::size_t>> columns, std::size_t rows) {
    std::vector<std::vector<bool>> pivots(rows);
    std::size_t rank = 0;
    for (const auto& column : columns) {
        std::vector<bool> bits(rows, false);
        for (const std::size_t r : column) bits[r] = !bits[r];
        for (std::size_t r = rows; r-- > 0;) {
            if (!bits[r]) continue;
            if (pivots[r].empty()) {
                pivots[r] = bits;
                ++rank;
                break;
            }
            for (std::size_t i = 0; i <= r; ++i) bits[i] = bits[i] != pivots[r][i];
        }
    }
    return rank;
}

/// Betti numbers from the ranks of the boundary maps, independent of how the library counts.
Betti byHomology(const VoxelSpace& space) {
    const CubicalComplex complex(space);
    const std::size_t n = complex.corners();
    std::array<std::vector<std::vector<std::size_t>>, 4> boundary;
    for (std::size_t c = 0; c < n; ++c) {
        for (CellAxes axes = 1; axes < 8; ++axes) {
            if (!complex.has(c, axes)) continue;
            std::vector<std::size_t> faces;
            for (int a = 0; a < 3; ++a) {
                if (!(axes >> a & 1u)) continue;
                const CellAxes face = axes & ~(1u << a);
                faces.push_back(c * 8 + face);
                faces.push_back((c + complex.step(a)) * 8 + face);
            }
            boundary[std::size_t(std::popcount(axes))].push_back(faces);
        }
    }
    std::size_t rank[5] = {0, 0, 0, 0, 0};
    for (std::size_t d = 1; d <= 3; ++d) rank[d] = rankOf(boundary[d], n * 8);
    const auto betti = [&](int d) {
        return std::int64_t(complex.count(d)) - std::int64_t(rank[d]) - std::int64_t(rank[d + 1]);
    };
    return {betti(0), betti(1), betti(2)};
}

TEST(Topology, countsAgreeWithHomology) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const VoxelSpace space = randomSpace({4, 5, 4}, 0.3 + 0.03 * double(seed % 10), seed);
        EXPECT_EQ(emptySpaceBetti(space), byHomology(space)) << "seed " << seed;
    }
}

TEST(Topology, randomShapes) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const double solid = 0.05 + 0.9 * double(seed % 20) / 20.0;
        const VoxelSpace space = randomSpace({9, 10, 8}, solid, seed);
        expectSkeleton(space, emptySpaceBetti(space), "seed " + std::to_string(seed));
    }
}

TEST(Skeleton, isCentred) {
    // In a corridor of square section, the skeleton runs along the middle. Collapse leaves a medial
    // line of 21 of the 28 voxels, and the opening removes 4 at each end.
    const VoxelSpace space = drawn({30, 9, 9}, [](int x, int y, int z) {
        return x == 0 || x == 29 || y == 0 || y == 8 || z == 0 || z == 8;
    });
    const Graphs g = skeletonOf(space);
    EXPECT_GE(g.raw.edges.size(), 12u);
    for (const SkeletonNode& n : g.raw.nodes) {
        EXPECT_NEAR(n.position.y, 4.5, 1.0);
        EXPECT_NEAR(n.position.z, 4.5, 1.0);
        EXPECT_DOUBLE_EQ(n.radius, distanceToSolid(space, n.position));
    }
    // In a slanted tunnel, nodes are near the axis, as exactly as voxels allow.
    const Vec3d axis = normalize(Vec3d{2, 1, 1});
    const VoxelSpace slanted = drawn({32, 20, 20}, [&](int x, int y, int z) {
        const Vec3d p = Vec3d{x + 0.5, y + 0.5, z + 0.5} - Vec3d{16, 10, 10};
        return length(p - axis * dot(p, axis)) > 4.0 || x == 0 || x == 31;
    });
    for (const SkeletonNode& n : skeletonOf(slanted).raw.nodes) {
        const Vec3d p = n.position - Vec3d{16, 10, 10};
        EXPECT_LT(length(p - axis * dot(p, axis)), 1.75) << n.position.x;
    }
}

TEST(Skeleton, isTheSameForAnyThreadsAndMovesWithTheShape) {
    const auto solid = [](int x, int y, int z) {
        return (x * 7 + y * 13 + z * 5) % 11 < 2 && (x + y + z) % 3 != 0;
    };
    const VoxelSpace space = drawn({18, 16, 14}, solid);
    const Graphs one = skeletonOf(space, 1);
    for (const int threads : {2, 7}) {
        const Graphs more = skeletonOf(space, threads);
        ASSERT_EQ(more.raw.nodes.size(), one.raw.nodes.size());
        ASSERT_EQ(more.raw.edges, one.raw.edges);
        for (std::size_t i = 0; i < one.raw.nodes.size(); ++i) {
            EXPECT_EQ(more.raw.nodes[i].position, one.raw.nodes[i].position);
            EXPECT_EQ(more.raw.nodes[i].radius, one.raw.nodes[i].radius);
        }
        ASSERT_EQ(more.filtered.nodes.size(), one.filtered.nodes.size());
    }
    // The same shape three voxels on in a larger grid, enclosed by solid voxels.
    const VoxelSpace moved = drawn({25, 22, 20}, [&](int x, int y, int z) {
        x -= 3;
        y -= 3;
        z -= 3;
        return x < 0 || y < 0 || z < 0 || x >= 18 || y >= 16 || z >= 14 || solid(x, y, z);
    });
    const Betti here = emptySpaceBetti(space), there = emptySpaceBetti(moved);
    EXPECT_EQ(here, there);
    // Turned by 90 degrees about z.
    const VoxelSpace turned =
        drawn({16, 18, 14}, [&](int x, int y, int z) { return solid(y, 15 - x, z); });
    EXPECT_EQ(emptySpaceBetti(turned), here);
    const Graphs g = skeletonOf(turned);
    EXPECT_EQ(g.raw.b1(), one.raw.b1());
    EXPECT_NEAR(double(g.raw.nodes.size()), double(one.raw.nodes.size()),
                0.15 * double(one.raw.nodes.size()));
}

TEST(Skeleton, movesWithTheShapeAcrossWordsOfCorners) {
    // A room of 10 x 7 x 6 voxels in solid, moved along x across the 64th corner.
    const VoxelIndex size{10, 7, 6};
    const auto at = [&](int offset) {
        return drawn({76, 9, 8}, [&](int x, int y, int z) {
            const int rx = x - offset, ry = y - 1, rz = z - 1;
            if (rx < 0 || ry < 0 || rz < 0 || rx >= size[0] || ry >= size[1] || rz >= size[2]) {
                return true;
            }
            return (rx * 7 + ry * 13 + rz * 5) % 23 < 2;
        });
    };
    const Graphs first = skeletonOf(at(1));
    EXPECT_GE(first.raw.nodes.size(), 10u);
    for (const int offset : {52, 54, 57, 60, 61, 62, 63, 64}) {
        const Graphs moved = skeletonOf(at(offset));
        ASSERT_EQ(moved.raw.nodes.size(), first.raw.nodes.size()) << offset;
        EXPECT_EQ(moved.raw.edges, first.raw.edges) << offset;
        for (std::size_t i = 0; i < first.raw.nodes.size(); ++i) {
            const Vec3d by{double(offset - 1), 0, 0};
            EXPECT_EQ(moved.raw.nodes[i].position, first.raw.nodes[i].position + by) << offset;
        }
    }
}

}  // namespace
}  // namespace lacuna::test
