// Compares the light tree's cuts and draws with brute force.
#include "libcore/resampling/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/parallel.h"
#include "libcore/material/albedo_tables.h"

namespace lacuna::test {
namespace {

/// `places` subpaths of one vertex in a unit cube and `directions` of one at infinity. Powers span
/// ten decades, and every seventh vertex has none.
LightPool somePool(int places, int directions) {
    LightPool pool;
    pool.reset(std::uint64_t(places + directions));
    Rng rng(4, 0, StreamKind::User, 0);
    const auto draw = [&] {
        const float x = rng.uniform(), y = rng.uniform(), z = rng.uniform();
        return Vec3{x - 0.5f, y - 0.5f, z - 0.5f};
    };
    for (int i = 0; i < places + directions; ++i) {
        PathVertex v;
        v.kind = i < places ? VertexKind::LightSource : VertexKind::Infinite;
        v.position = i < places ? draw() : normalize(draw());
        if (i % 3 == 0) v.ng = normalize(draw());
        const float power = std::pow(10.0f, 10.0f * rng.uniform() - 5.0f);
        v.throughput = i % 7 == 6 ? Rgb{} : Rgb{power, 2 * power, 0};
        pool.add({&v, 1}, 12);
    }
    return pool;
}

PathVertex someEye(Vec3 position, Vec3 normal) {
    PathVertex z;
    z.position = position;
    z.ng = z.toPrevious = normal;
    return z;
}

TEST(LightTree, cutsHoldEveryVertexWithPowerOnceAndKnowTheirPower) {
    const ThreadPool threads(2);
    for (const auto& [places, directions] :
         {std::pair{0, 0}, {1, 0}, {0, 1}, {5, 3}, {400, 150}, {5000, 0}, {0, 300}}) {
        const LightPool pool = somePool(places, directions);
        const LightTree tree(pool, pool.connectable(), threads);
        const auto powerOf = [&](std::uint32_t candidate) {
            return double(mean(pool.prefix(pool.connectable()[candidate]).back().throughput));
        };
        std::size_t powered = 0;
        for (std::uint32_t i = 0; i < pool.connectable().size(); ++i) powered += powerOf(i) > 0;
        ASSERT_EQ(tree.size(), powered);
        std::vector<LightTree::CutNode> heap;
        std::vector<LightTree::Cluster> cut;
        for (const std::size_t budget : {1u, 2u, 3u, 50u, 100000u}) {
            tree.cut(someEye({0.2f, 0.1f, -0.3f}, {0, 0, 1}), budget, heap, cut);
            EXPECT_LE(cut.size(), std::max<std::size_t>(budget, 2));
            if (budget >= powered) {
                EXPECT_EQ(cut.size(), powered) << "each its own cluster";
            }
            std::vector<int> times(pool.connectable().size());
            for (const LightTree::Cluster c : cut) {
                ASSERT_FALSE(tree.candidates(c).empty());
                double sum = 0.0;
                for (const std::uint32_t i : tree.candidates(c)) {
                    ++times[i];
                    sum += powerOf(i);
                }
                EXPECT_NEAR(tree.power(c) / sum, 1.0, 1e-12);
            }
            for (std::uint32_t i = 0; i < times.size(); ++i) {
                EXPECT_EQ(times[i], powerOf(i) > 0.0 ? 1 : 0);
            }
        }
    }
}

TEST(LightTree, drawsInProportionToPower) {
    const ThreadPool threads(1);
    const LightPool pool = somePool(40, 20);
    const LightTree tree(pool, pool.connectable(), threads);
    std::vector<LightTree::CutNode> heap;
    std::vector<LightTree::Cluster> cut;
    tree.cut(someEye({0, 0, 0}, {0, 1, 0}), 5, heap, cut);
    for (const LightTree::Cluster c : cut) {
        constexpr int kDraws = 5000;
        std::vector<int> times(pool.connectable().size());
        for (int i = 0; i < kDraws; ++i) {
            const LightTree::Draw d = tree.draw(c, (i + 0.5) / kDraws);
            const double own =
                double(mean(pool.prefix(pool.connectable()[d.candidate]).back().throughput));
            EXPECT_NEAR(d.pmf / (own / tree.power(c)), 1.0, 1e-12);
            ++times[d.candidate];
        }
        for (const std::uint32_t i : tree.candidates(c)) {
            const double own = double(mean(pool.prefix(pool.connectable()[i]).back().throughput));
            EXPECT_NEAR(times[i], kDraws * own / tree.power(c), 1.001);
        }
        EXPECT_GT(tree.draw(c, 0.0).pmf, 0.0);
        EXPECT_GT(tree.draw(c, 1.0 - 0x1p-53).pmf, 0.0);
    }
}

TEST(LightTree, threadsChangeNothing) {
    const LightPool pool = somePool(6000, 3000);
    std::vector<LightTree::Cluster> first, cut;
    std::vector<std::uint32_t> firstOrder;
    std::vector<LightTree::CutNode> heap;
    for (const int n : {1, 2, 7}) {
        const ThreadPool threads(n);
        const LightTree tree(pool, pool.connectable(), threads);
        tree.cut(someEye({0.3f, 0, 0}, {1, 0, 0}), 200, heap, cut);
        std::vector<std::uint32_t> order;
        for (const LightTree::Cluster c : cut) {
            order.insert(order.end(), tree.candidates(c).begin(), tree.candidates(c).end());
        }
        if (n == 1) {
            first = cut;
            firstOrder = order;
        }
        EXPECT_EQ(order, firstOrder);
        EXPECT_EQ(cut, first);
    }
}

/// A near cluster is cut more finely than one of the same power far away.
TEST(LightTree, cutsAreFineWhereLightIsNear) {
    const ThreadPool threads(1);
    LightPool pool;
    pool.reset(200);
    Rng rng(6, 0, StreamKind::User, 0);
    for (int i = 0; i < 200; ++i) {
        PathVertex v;
        v.kind = VertexKind::LightSource;
        const float far = i < 100 ? 1.0f : 50.0f;
        const float x = rng.uniform(), y = rng.uniform(), z = rng.uniform();
        v.position = Vec3{far + x, y, z};
        v.throughput = Rgb(1.0f);
        pool.add({&v, 1}, 12);
    }
    const LightTree tree(pool, pool.connectable(), threads);
    std::vector<LightTree::CutNode> heap;
    std::vector<LightTree::Cluster> cut;
    tree.cut(someEye({0, 0, 0}, {1, 0, 0}), 30, heap, cut);
    std::size_t near = 0;
    for (const LightTree::Cluster c : cut) near += tree.candidates(c)[0] < 100;
    EXPECT_GE(near, 25u);
}

/// Makes two clusters of a hundred lamps each and returns how many parts of a cut hold lamps of the
/// first. `describe` turns a position in a unit cube around the origin into a lamp.
template <class Describe>
std::size_t partsOfTheFirst(const PathVertex& eye, const Describe& describe,
                            std::size_t parts = 30) {
    const ThreadPool threads(1);
    LightPool pool;
    pool.reset(200);
    Rng rng(7, 0, StreamKind::User, 0);
    for (int i = 0; i < 200; ++i) {
        PathVertex v;
        v.kind = VertexKind::LightSource;
        const float x = rng.uniform(), y = rng.uniform(), z = rng.uniform();
        v.position = Vec3{x - 0.5f, y - 0.5f, z - 0.5f};
        v.throughput = Rgb(1.0f);
        describe(i < 100, v);
        pool.add({&v, 1}, 12);
    }
    const LightTree tree(pool, pool.connectable(), threads);
    std::vector<LightTree::CutNode> heap;
    std::vector<LightTree::Cluster> cut;
    tree.cut(eye, parts, heap, cut);
    EXPECT_EQ(cut.size(), parts);
    std::size_t first = 0;
    for (const LightTree::Cluster c : cut) first += tree.candidates(c)[0] < 100;
    return first;
}

/// Lamps that turn their back to the point send it nothing, so the cut is fine among those that
/// face it.
TEST(LightTree, cutsAreFineWhereLampsFaceThePoint) {
    const PathVertex eye = someEye({}, {});
    const auto facing = [](float turn) {
        return [turn](bool first, PathVertex& v) {
            v.position = v.position + Vec3{first ? 4.0f : -4.0f, 0, 0};
            v.ng = {-turn, 0, 0};  // one cluster faces the eye, the other turns away
        };
    };
    EXPECT_GE(partsOfTheFirst(eye, facing(1.0f)), 25u);
    EXPECT_LE(partsOfTheFirst(eye, facing(-1.0f)), 5u);
    // Vertices on surfaces face the side that their light came from.
    const AlbedoTables none;
    const Bsdf grey({.baseColor = Rgb(0.5f), .specular = 0.0f}, {1, 0, 0}, {1, 0, 0}, none);
    const auto reflecting = [&](bool first, PathVertex& v) {
        v.kind = VertexKind::Surface;
        v.position = v.position + Vec3{first ? 4.0f : -4.0f, 0, 0};
        v.ng = {1, 0, 0};
        v.toPrevious = {-1, 0, 0};
        v.bsdf = grey;
    };
    EXPECT_GE(partsOfTheFirst(eye, reflecting), 25u);
}

/// Two-sided lamps shine both ways.
TEST(LightTree, cutsAreAlikeForTwoSidedLampsThatFaceAndTurnAway) {
    const std::size_t facing = partsOfTheFirst(someEye({}, {}), [](bool first, PathVertex& v) {
        v.position = v.position + Vec3{first ? 4.0f : -4.0f, 0, 0};
        v.ng = {1, 0, 0};
        v.twoSided = true;
    });
    EXPECT_GE(facing, 10u);
    EXPECT_LE(facing, 20u);
}

/// Transmitting surfaces send light to both sides, wherever it came from.
TEST(LightTree, cutsAreAlikeForTransmittersThatFaceAndTurnAway) {
    const AlbedoTables none;
    const Bsdf glass({.roughness = 0.5f, .transmission = 1.0f}, {1, 0, 0}, {1, 0, 0}, none);
    const std::size_t facing = partsOfTheFirst(someEye({}, {}), [&](bool first, PathVertex& v) {
        v.kind = VertexKind::Surface;
        v.position = v.position + Vec3{first ? 4.0f : -4.0f, 0, 0};
        v.ng = {1, 0, 0};
        v.toPrevious = {-1, 0, 0};
        v.bsdf = glass;
    });
    EXPECT_GE(facing, 10u);
    EXPECT_LE(facing, 20u);
}

/// The near end of a long row of lamps counts, however far its middle is.
TEST(LightTree, cutsAreFineWhereTheEndOfARowIsNear) {
    const auto describe = [](bool first, PathVertex& v) {
        v.position =
            first ? Vec3{60.0f * v.position.x + 31.0f, 0, 0} : v.position + Vec3{-20, 0, 0};
    };
    EXPECT_EQ(partsOfTheFirst(someEye({}, {}), describe, 3), 2u);
}

/// The point's surface sees nothing behind it, near or at infinity.
TEST(LightTree, cutsAreFineWhereThePointFacesTheLamps) {
    const auto around = [](bool first, PathVertex& v) {
        v.position = v.position + Vec3{first ? 4.0f : -4.0f, 0, 0};
    };
    const auto sky = [](bool first, PathVertex& v) {
        v.kind = VertexKind::Infinite;
        v.position = normalize(v.position + Vec3{first ? 1.5f : -1.5f, 0, 0});
    };
    for (const float side : {1.0f, -1.0f}) {
        SCOPED_TRACE(side);
        // The point lies on the side of its surface that its path came from, whichever way the
        // normal points.
        PathVertex eye = someEye({}, {side, 0, 0});
        for (const float normal : {1.0f, -1.0f}) {
            eye.ng = {normal, 0, 0};
            const std::size_t near = partsOfTheFirst(eye, around);
            const std::size_t far = partsOfTheFirst(eye, sky);
            EXPECT_GE(side > 0 ? near : 30 - near, 25u);
            EXPECT_GE(side > 0 ? far : 30 - far, 25u);
        }
    }
}

}  // namespace
}  // namespace lacuna::test
