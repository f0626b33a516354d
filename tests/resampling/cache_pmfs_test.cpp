// Compares the pmfs of cache points with brute force.
#include "libcore/resampling/cache_pmfs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lacuna::test {
namespace {

std::vector<WeightedVertex> someWeights(Rng& rng, int n, bool wild) {
    std::vector<WeightedVertex> row;
    std::uint32_t index = 0;
    for (int i = 0; i < n; ++i) {
        index += 1 + rng.below(3);
        const double u = rng.uniformDouble();
        row.push_back({index, wild ? std::pow(10.0, 60.0 * u - 30.0) : 0.1 + u});
    }
    return row;
}

TEST(CachePmfs, areTheWeightsOverTheirSum) {
    Rng rng(2, 0, StreamKind::User, 0);
    for (const bool wild : {false, true}) {
        std::vector<std::vector<WeightedVertex>> rows;
        std::vector<CachePmfs::Builder> builders(3);
        for (int r = 0; r < 12; ++r) {
            rows.push_back(someWeights(rng, r % 4 == 0 ? 0 : 3 * r, wild));
            builders[std::size_t(r / 4)].add(rows.back());
        }
        const CachePmfs pmfs(builders);
        ASSERT_EQ(pmfs.rows(), rows.size());
        for (std::uint32_t r = 0; r < rows.size(); ++r) {
            ASSERT_EQ(pmfs.empty(r), rows[r].empty());
            double total = 0.0, sum = 0.0;
            for (const WeightedVertex& w : rows[r]) total += w.weight;
            for (const WeightedVertex& w : rows[r]) {
                const double pmf = pmfs.pmf(r, w.index);
                EXPECT_NEAR(pmf, w.weight / total, 1.2e-7);  // two roundings to float
                sum += pmf;
                EXPECT_EQ(pmfs.pmf(r, w.index + 1000), 0.0);
            }
            if (rows[r].empty()) continue;
            EXPECT_EQ(sum, 1.0);
            // Picks at evenly spaced u meet each vertex as often as its pmf says, and return that
            // pmf.
            constexpr int kPicks = 4000;
            std::vector<int> count(100);
            for (int i = 0; i < kPicks; ++i) {
                const CachePmfs::Pick pick = pmfs.pick(r, (i + 0.5) / kPicks);
                EXPECT_GT(pick.pmf, 0.0);
                EXPECT_EQ(pick.pmf, pmfs.pmf(r, pick.index));
                ++count.at(pick.index);
            }
            for (const WeightedVertex& w : rows[r]) {
                EXPECT_NEAR(count[w.index], kPicks * pmfs.pmf(r, w.index), 1.001);
            }
            EXPECT_GT(pmfs.pick(r, 0.0).pmf, 0.0);
            EXPECT_GT(pmfs.pick(r, 1.0 - 0x1p-53).pmf, 0.0);
        }
    }
}

TEST(CachePmfs, ofZeroWeightsAreEmpty) {
    std::vector<CachePmfs::Builder> builders(1);
    builders[0].add(std::vector<WeightedVertex>{{3, 0.0}, {7, 0.0}});
    builders[0].add(std::vector<WeightedVertex>{{3, 0.0}, {7, 1e-300}, {9, 0.0}});
    const CachePmfs pmfs(builders);
    EXPECT_TRUE(pmfs.empty(0));
    EXPECT_EQ(pmfs.pmf(0, 3), 0.0);
    for (const double u : {0.0, 0.5, 1.0 - 0x1p-53}) EXPECT_EQ(pmfs.pick(1, u).index, 7u);
    EXPECT_EQ(pmfs.pmf(1, 7), 1.0);
}

TEST(CachePmfs, keepNothingThatIsNeverPicked) {
    std::vector<CachePmfs::Builder> all(1), picked(1);
    all[0].add(std::vector<WeightedVertex>{{2, 0.0}, {3, 1.0}, {5, 1e-30}, {8, 0.0}});
    picked[0].add(std::vector<WeightedVertex>{{3, 1.0}});
    EXPECT_EQ(CachePmfs(all).bytes(), CachePmfs(picked).bytes());
}

}  // namespace
}  // namespace lacuna::test
