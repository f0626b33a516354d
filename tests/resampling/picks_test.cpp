// How often an eye vertex is connected: the picks, and what the weights assume.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/resampling/length_pmfs.h"
#include "libcore/resampling/picks.h"
#include "tests/fixtures/finite_space.h"

namespace lacuna::test {
namespace {

Connection connection(int s, int order) {
    Connection c{};
    c.light.count = s;
    c.order = order;
    return c;
}

TEST(Picks, manyAtTheFirstEyeVertex) {
    const Picks picks{12, 3, 1};
    EXPECT_EQ(picks.at(1), 12);
    EXPECT_EQ(picks.at(2), 3);
    EXPECT_EQ(picks.at(3), 1);
    EXPECT_EQ(picks.at(9), 1);
}

// In a path x_0 .. x_5, weights and selectors agree on the order of eye vertices: behind a mirror
// at x_4, x_3 is the first.
TEST(Picks, mirrorsAndGlassDoNotCount) {
    FullPath path;
    path.edges = 5;
    path.delta.fill(false);
    EXPECT_EQ(path.orderOf(4), 1);
    EXPECT_EQ(path.orderOf(3), 2);
    EXPECT_EQ(path.orderOf(1), 4);
    path.delta[4] = true;
    EXPECT_EQ(path.orderOf(3), 1);
    EXPECT_EQ(path.orderOf(2), 2);

    const FiniteSpace lights(3);
    RayTally tally;
    std::vector<PathVertex> eye(4);  // z_0 .. z_3 = x_5 .. x_2
    eye[1].event = ScatterEvent::DeltaReflection;
    eye[2].event = ScatterEvent::Smooth;
    eye[3].event =
        ScatterEvent::DeltaTransmission;  // belongs to the continued walk, not to a connection
    const auto orderOf = [&](std::size_t t) {
        return EyeContext{eye[t - 1], {eye.data(), t}, {}, 0, 0, lights, lights, tally}.order();
    };
    EXPECT_EQ(orderOf(2), 1);
    EXPECT_EQ(orderOf(3), path.orderOf(3));
    EXPECT_EQ(orderOf(4), path.orderOf(2));
}

TEST(Picks, noneSaidIsAsManyAsElsewhere) {
    EXPECT_TRUE((PickOptions{.connections = 5}.picks().alike()));
    EXPECT_EQ((PickOptions{.connections = 5}.picks().first), 5);
    const Picks more = PickOptions{.connections = 5, .first = 7, .deep = 2}.picks();
    EXPECT_EQ(more.first, 7);
    EXPECT_EQ(more.second, 5);
    EXPECT_EQ(more.later, 2);
}

TEST(Picks, countInTheDensity) {
    const PicksDensity alike({3, 3, 3}, true, Lamps::Power, 0.25);
    ASSERT_TRUE(alike.constants());
    EXPECT_EQ(alike.constants()->direct, 1.0);  // next event: one fresh light point
    EXPECT_EQ(alike.constants()->indirect, 0.75);
    const PicksDensity differing({8, 1, 1}, false, Lamps::Power, 0.25);
    EXPECT_FALSE(differing.constants());
    EXPECT_EQ(differing.effectiveSamples(connection(1, 1)), 2.0);
    EXPECT_EQ(differing.effectiveSamples(connection(3, 1)), 2.0);
    EXPECT_EQ(differing.effectiveSamples(connection(3, 2)), 0.25);
}

// Two of eight light subpaths go on to y_3: this length has half of an eye vertex's picks.
TEST(Picks, followTheShareOfALength) {
    LightPool pool;
    pool.reset(8);
    for (int i = 0; i < 8; ++i) {
        std::vector<PathVertex> path(i < 2 ? 4 : 2);
        for (std::size_t v = 0; v < path.size(); ++v) {
            path[v].kind = VertexKind::LightSource;
            path[v].index = std::uint16_t(v);
        }
        pool.add(path, 12);
    }
    VerticesByLength vertices;
    vertices.assign(pool, false);
    LengthPicks picks(Lengths::Share, {3, 1, 1});
    picks.learn(vertices);
    EXPECT_EQ(picks.at(2, 1), 3.0);
    EXPECT_EQ(picks.at(4, 1), 1.5);
    EXPECT_EQ(picks.at(4, 2), 0.5);
    EXPECT_EQ(picks.chance(4, 1), 1.0);
    EXPECT_EQ(picks.repeats(4, 1), 1.5);
    EXPECT_EQ(picks.chance(4, 2), 0.5);
    EXPECT_EQ(picks.repeats(4, 2), 1.0);

    constexpr int kDraws = 20000;
    Rng rng(51, 0, StreamKind::Connection, 0);
    for (const int order : {1, 2}) {
        double count = 0, sumOfU = 0;
        for (int i = 0; i < kDraws; ++i) {
            int atOnce = 0;
            picks.forEachPick(vertices, order, rng, [&](int s, double u, double n) {
                EXPECT_EQ(n, picks.at(s, order));
                ASSERT_GE(u, 0.0);
                ASSERT_LT(u, 1.0);
                if (s != 4) return;
                ++atOnce;
                sumOfU += u;
            });
            EXPECT_LE(std::abs(atOnce - picks.at(4, order)), 0.5);
            count += atOnce;
        }
        // In both orders, the count deviates by 1/2 per draw. 4.5 standard errors: 7e-6 false
        // alarms.
        EXPECT_NEAR(count / kDraws, picks.at(4, order), 4.5 * 0.5 / std::sqrt(kDraws));
        // Uniform numbers deviate by sqrt(1/12).
        EXPECT_NEAR(sumOfU / count, 0.5, 4.5 / std::sqrt(12.0 * count));
    }
}

}  // namespace
}  // namespace lacuna::test
