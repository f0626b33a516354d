// Light vertices by length, and one pmf made of several.
#include "libcore/resampling/length_pmfs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace lacuna::test {
namespace {

/// One light subpath of each length.
LightPool poolOf(const std::vector<int>& lengths) {
    LightPool pool;
    pool.reset(lengths.size());
    for (const int length : lengths) {
        std::vector<PathVertex> path(static_cast<std::size_t>(length));
        for (std::size_t v = 0; v < path.size(); ++v) {
            path[v].kind = VertexKind::LightSource;
            path[v].index = std::uint16_t(v);
        }
        pool.add(path, 12);
    }
    return pool;
}

TEST(VerticesByLength, liesLengthByLength) {
    const LightPool pool = poolOf({1, 4, 2, 0, 4, 2, 2});
    VerticesByLength vertices;
    EXPECT_EQ(vertices.lengths(), 0);
    for (const bool direct : {true, false}) {
        vertices.assign(pool, direct);
        ASSERT_EQ(vertices.lengths(), 4);
        EXPECT_EQ(vertices.count(1), direct ? 6u : 0u);
        EXPECT_EQ(vertices.count(2), 5u);
        EXPECT_EQ(vertices.count(3), 2u);
        EXPECT_EQ(vertices.count(4), 2u);
        EXPECT_EQ(vertices.size(), direct ? 15u : 9u);
        for (int s = 1; s <= 4; ++s) {
            for (std::size_t i = 0; i < vertices.count(s); ++i) {
                EXPECT_EQ(vertices.prefix(vertices.begin(s) + i).size(), std::size_t(s));
            }
        }
    }
    vertices.assign(poolOf({}), true);
    EXPECT_EQ(vertices.lengths(), 0);
    EXPECT_EQ(vertices.size(), 0u);
}

TEST(LengthPicks, everyLengthAlikeOrOneThatWasNeverSeen) {
    VerticesByLength vertices;
    vertices.assign(poolOf({4, 2, 2, 2, 2, 2, 2, 2}), false);
    LengthPicks every(Lengths::Every, {3, 2, 1}), share(Lengths::Share, {3, 2, 1});
    every.learn(vertices);
    for (const int s : {1, 2, 3, 4, 9}) {
        EXPECT_EQ(every.at(s, 1), 3.0) << s;
        EXPECT_EQ(every.at(s, 7), 1.0) << s;
        EXPECT_EQ(share.at(s, 2), 2.0) << "nothing learnt yet: " << s;
    }
    share.learn(vertices);
    EXPECT_EQ(share.at(4, 2), 2.0 * 2.0 / 8.0);
    EXPECT_EQ(share.at(5, 2), 2.0) << "never seen";
    // A second iteration without long subpaths halves their share.
    vertices.assign(poolOf({2, 2, 2, 2, 2, 2, 2, 2}), false);
    share.learn(vertices);
    EXPECT_EQ(share.at(4, 2), 2.0 * 2.0 / 16.0);
    EXPECT_EQ(share.at(2, 2), 2.0) << "the shortest are never fewer";
}

CombinedPmf combined(const std::vector<std::vector<double>>& targets) {
    return CombinedPmf(std::vector<std::span<const double>>(targets.begin(), targets.end()));
}

// The targets' probabilities are .8 .1 .1 0 and .25 .25 .25 .25. The first target owns the first
// outcome alone. The second target owns the others, a third each. Each target is chosen with
// probability 1/2.
TEST(CombinedPmf, outcomesBelongToWhoGivesThemMost) {
    const CombinedPmf pmf = combined({{8, 1, 1, 0}, {5, 5, 5, 5}});
    ASSERT_FALSE(pmf.empty());
    EXPECT_EQ(pmf.owner(0), 0u);
    EXPECT_NEAR(pmf.pmf(0), 0.5, 1e-7);
    for (const std::size_t i : {1, 2, 3}) {
        EXPECT_EQ(pmf.owner(i), 1u);
        EXPECT_NEAR(pmf.pmf(i), 0.5 / 3.0, 1e-7);
    }
    EXPECT_EQ(pmf.sum(0), 10.0);
    EXPECT_EQ(pmf.sum(1), 20.0);
    EXPECT_NEAR(pmf.maxima(), 0.8 + 3 * 0.25, 1e-12);
}

TEST(CombinedPmf, isChosenAllAlikeAndDrawsWhatItSays) {
    // The targets own one, one and two outcomes. Within a target's third, outcomes are proportional
    // to its weights.
    const CombinedPmf pmf = combined({{9, 1, 1, 1}, {0, 6, 0, 0}, {1, 1, 3, 5}});
    const std::array<double, 4> expected = {1.0 / 3, 1.0 / 3, 1.0 / 8, 5.0 / 24};
    constexpr int kDraws = 12000;
    std::array<int, 4> count{};
    for (int i = 0; i < kDraws; ++i) {
        const AliasTable::Pick pick = pmf.sample((i + 0.5) / kDraws);
        EXPECT_EQ(double(pick.pmf), pmf.pmf(pick.index));
        ++count.at(pick.index);
    }
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(pmf.pmf(i), expected[i], 1e-6) << i;
        // Evenly spaced draws miss each column of an alias table by at most one.
        EXPECT_NEAR(count[i], kDraws * expected[i], 4.01) << i;
    }
}

TEST(CombinedPmf, tiesGoToTheFirstAndTargetsWithoutWeightAreLeftOut) {
    const CombinedPmf alike = combined({{1, 1}, {2, 2}});
    EXPECT_EQ(alike.owner(0), 0u);
    EXPECT_EQ(alike.owner(1), 0u);
    EXPECT_NEAR(alike.pmf(0), 0.5, 1e-7);
    EXPECT_DOUBLE_EQ(alike.maxima(), 1.0);

    const CombinedPmf one = combined({{0, 0, 0}, {3, 0, 1}});
    EXPECT_NEAR(one.pmf(0), 0.75, 1e-7);
    EXPECT_EQ(one.pmf(1), 0.0) << "no target has it";
    EXPECT_NEAR(one.pmf(2), 0.25, 1e-7);
    EXPECT_EQ(one.owner(2), 1u);
    EXPECT_EQ(one.sum(0), 0.0);
    EXPECT_DOUBLE_EQ(one.maxima(), 1.0);

    for (const CombinedPmf& none :
         {combined({{0, 0}, {0, 0}}), combined({{}, {}}), combined({}), CombinedPmf()}) {
        EXPECT_TRUE(none.empty());
        EXPECT_EQ(none.maxima(), 0.0);
    }
}

/// Targets without a common outcome: the sum of maxima is their number.
TEST(CombinedPmf, maximaOfDisjointTargetsAreTheirNumber) {
    EXPECT_DOUBLE_EQ(combined({{1, 0, 0}, {0, 7, 0}, {0, 0, 1e-300}}).maxima(), 3.0);
}

}  // namespace
}  // namespace lacuna::test
