// Piecewise constant densities on the unit square. False alarms: 1e-6 for each comparison.
#include "libcore/base/square_density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/base/chi_square.h"
#include "tests/base/random_density.h"

namespace lacuna::test {
namespace {

using Node = SquareDensity::Node;
constexpr std::uint32_t kInner = SquareDensity::kInner, kSecond = SquareDensity::kSecondAxis;

TEST(SquareDensity, IsUniformByItself) {
    const SquareDensity d;
    EXPECT_EQ(d.at({0.3, 0.7}).pdf, 1.0);
    EXPECT_EQ(d.warp({0.3, 0.7}), (SquarePoint{0.3, 0.7}));
}

TEST(SquareDensity, KnowsItsHalves) {
    // The left half has a quarter of the mass. Of the right half's mass, the lower part has three
    // quarters.
    const SquareDensity d(
        {{0.25f, 1 | kInner}, {1, 0}, {0.75f, 3 | kInner | kSecond}, {1, 1}, {1, 2}});
    EXPECT_EQ(d.leafCount(), 3u);
    EXPECT_DOUBLE_EQ(d.at({0.1, 0.9}).pdf, 0.5);
    EXPECT_DOUBLE_EQ(d.at({0.9, 0.1}).pdf, 0.75 * 2 * 0.75 * 2);
    EXPECT_EQ(d.at({0.5, 0.5}).leaf, 2u) << "a half begins at its lower end";
    EXPECT_DOUBLE_EQ(d.warp({0.125, 0.4})[0], 0.25);
    EXPECT_DOUBLE_EQ(d.warp({0.25, 0.75})[0], 0.5);
    EXPECT_DOUBLE_EQ(d.warp({0.25, 0.75})[1], 0.5);
}

TEST(SquareDensity, PointsAreMovedWithTheDensityThatIsToldOfThem) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        Rng rng(seed, 0, StreamKind::User, 0);
        const SquareDensity d = randomDensity(rng, 20);
        constexpr int kCells = 16, kDraws = 100'000;
        std::vector<std::uint64_t> counts(kCells * kCells);
        std::vector<double> mass(counts.size());
        const auto cellOf = [](SquarePoint p) {
            return std::size_t(p[1] * kCells) * kCells + std::size_t(p[0] * kCells);
        };
        constexpr int kFine = 1 << 10;
        for (int y = 0; y < kFine; ++y) {
            for (int x = 0; x < kFine; ++x) {
                const SquarePoint p{(x + 0.5) / kFine, (y + 0.5) / kFine};
                mass[cellOf(p)] += d.at(p).pdf / (double(kFine) * kFine);
            }
        }
        double sum = 0;
        for (const double m : mass) sum += m;
        EXPECT_NEAR(sum, 1.0, 1e-6);
        for (int i = 0; i < kDraws; ++i) {
            const SquarePoint p = d.warp({rng.uniformDouble(), rng.uniformDouble()});
            ASSERT_LT(p[0], 1.0);
            ASSERT_LT(p[1], 1.0);
            ++counts[cellOf(p)];
        }
        EXPECT_GT(chiSquareSignificance(counts, mass, kDraws), 1e-6) << "seed " << seed;
    }
}

TEST(SquareDensity, RefusesWhatIsNoTree) {
    const auto refused = [](std::vector<Node> nodes) {
        EXPECT_THROW(SquareDensity(std::move(nodes)), std::invalid_argument);
    };
    refused({});
    refused({{0.5f, 1 | kInner}, {1, 0}});          // half of it missing
    refused({{0.5f, 0 | kInner}, {1, 0}, {1, 1}});  // its own child
    refused({{0.0f, 1 | kInner}, {1, 0}, {1, 1}});  // probability zero
    refused({{std::nanf(""), 1 | kInner}, {1, 0}, {1, 1}});
    refused({{0.5f, 1 | kInner}, {1, 0}, {1, 0}});                              // a leaf twice
    refused({{0.5f, 1 | kInner}, {1, 0}, {1, 7}});                              // no such leaf
    refused({{0.5f, 1 | kInner}, {1, 0}, {1, 1}, {1, 2}});                      // no parent
    refused({{0.5f, 1 | kInner}, {0.5f, 2 | kInner}, {1, 0}, {1, 1}, {1, 2}});  // two parents
    std::vector<Node> deep;
    for (std::uint32_t i = 0; i < 60; ++i) {
        deep.push_back({0.5f, (2 * i + 1) | kInner});
        deep.push_back({1, i});
    }
    refused(deep);
}

}  // namespace
}  // namespace lacuna::test
