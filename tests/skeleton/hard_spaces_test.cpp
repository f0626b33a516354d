// Degenerate empty spaces: one voxel, none, one flat layer. Also voxels of extreme sizes.
#include <gtest/gtest.h>

#include "libcore/base/parallel.h"
#include "libcore/skeleton/node_map.h"
#include "libcore/skeleton/topology.h"
#include "tests/fixtures/never.h"
#include "tests/skeleton/voxel_shapes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

struct Made {
    Betti empty;
    Thinned thinned;
    SkeletonGraph raw;
    FilteredGraph filtered;
    NodeMap map;
};

Made madeOf(const VoxelSpace& space) {
    const ThreadPool pool(2);
    Made m{emptySpaceBetti(space), thin(space, pool, kNever), {}, {}, {}};
    const auto radiusAt = [&](const Vec3d& p) { return distanceToSolid(space, p); };
    m.raw = extractGraph(m.thinned.complex, space.shape, radiusAt, pool);
    m.filtered = filterByMaximalBalls(m.raw);
    m.map = mapNodes(space, m.filtered.nodes, pool, kNever);
    return m;
}

TEST(HardSpaces, oneVoxelOfEmptySpace) {
    const auto around = [](int x, int y, int z) { return x != 1 || y != 1 || z != 1; };
    for (const VoxelSpace& space :
         {drawn({3, 3, 3}, around), drawn({1, 1, 1}, [](int, int, int) { return false; })}) {
        const Made m = madeOf(space);
        EXPECT_EQ(m.empty, (Betti{1, 0, 0}));
        EXPECT_EQ(m.raw.b0(), 1);
        EXPECT_EQ(m.raw.b1(), 0);
        ASSERT_EQ(m.filtered.nodes.size(), 1u);
        EXPECT_TRUE(isFinite(m.filtered.nodes[0].position));
        for (std::size_t i = 0; i < space.state.size(); ++i) {
            if (space.state[i] != VoxelState::Empty) continue;
            EXPECT_EQ(m.map.entries()[i], 0);
        }
    }
    stabilityCase("space-one-voxel", 1, "node");
}

TEST(HardSpaces, noEmptySpaceAtAll) {
    const VoxelSpace space = drawn({4, 3, 2}, [](int, int, int) { return true; });
    const Made m = madeOf(space);
    EXPECT_EQ(m.empty, (Betti{0, 0, 0}));
    EXPECT_EQ(m.thinned.punctures, 0u);
    EXPECT_TRUE(m.raw.nodes.empty());
    EXPECT_TRUE(m.filtered.nodes.empty());
    EXPECT_EQ(m.map.at({1, 1, 1}, {0, 1, 0}), NodeMap::kNone);
    stabilityCase("space-none", double(m.filtered.nodes.size()), "nodes");
}

/// A layer of space one voxel high, as between two floors.
TEST(HardSpaces, flatSpace) {
    const VoxelSpace space =
        drawn({14, 12, 1}, [](int x, int y, int) { return x == 6 && y != 3 && y != 9; });
    const Made m = madeOf(space);
    EXPECT_EQ(m.empty, (Betti{1, 1, 0}));
    EXPECT_EQ(m.raw.b1(), 1);
    EXPECT_EQ(m.filtered.b1(), 1);
    stabilityCase("space-flat", double(m.filtered.b1()), "loop, about one pillar");
}

/// Rooms of a thousandth and of a million units have the same skeleton, moved and scaled.
TEST(HardSpaces, sizeOfTheVoxels) {
    const auto rooms = [](int x, int y, int z) { return x == 9 && !(y > 2 && y < 6 && z < 5); };
    const VoxelSpace unit = drawn({18, 11, 8}, rooms);
    const Made expected = madeOf(unit);
    double worst = 0;
    for (const double voxel : {1e-3 / 18, 1e6 / 18}) {
        VoxelSpace space = unit;
        const Vec3d origin{-0.3 * voxel, 7.7 * voxel, voxel};
        space.shape = {unit.shape.size, origin, voxel};
        for (float& d : space.distance) d *= float(voxel);
        const ThreadPool pool(2);
        const Thinned thinned = thin(space, pool, kNever);
        const auto radiusAt = [&](const Vec3d& p) {
            return voxel * distanceToSolid(unit, (p - origin) * (1 / voxel));
        };
        const SkeletonGraph raw = extractGraph(thinned.complex, space.shape, radiusAt, pool);
        ASSERT_EQ(raw.edges, expected.raw.edges) << voxel;
        for (std::size_t i = 0; i < raw.nodes.size(); ++i) {
            const Vec3d p = (raw.nodes[i].position - origin) * (1 / voxel);
            worst = std::max(worst, length(p - expected.raw.nodes[i].position));
        }
        const FilteredGraph filtered = filterByMaximalBalls(raw);
        EXPECT_EQ(filtered.nodes.size(), expected.filtered.nodes.size()) << voxel;
        const NodeMap map = mapNodes(space, filtered.nodes, pool, kNever);
        EXPECT_TRUE(
            std::equal(map.entries().begin(), map.entries().end(), expected.map.entries().begin()))
            << voxel;
    }
    EXPECT_LT(worst, 1e-9);
    stabilityCase("space-scale", worst, "voxels off, at most");
}

}  // namespace
}  // namespace lacuna::test
