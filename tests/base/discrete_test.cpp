// Picking by weight (numerics.md, "Picking by weight"). False alarms: 1e-3 over all comparisons of
// this file.
#include "libcore/base/discrete.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

#include "libcore/base/rng.h"
#include "tests/base/chi_square.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

constexpr double kAlarm = 1e-3;
constexpr double kComparisons = 16;
constexpr double kLast = 0x1.fffffffffffffp-1;  // largest u below one

/// What must hold for all weights: the pmf adds up to one and is realised, and zeros are never
/// picked.
void checkInvariants(const std::vector<double>& weights) {
    const DiscreteDistribution d{weights};
    ASSERT_EQ(d.size(), weights.size());
    ASSERT_FALSE(d.empty());
    long double sum = 0, total = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        ASSERT_GE(d.pmf(i), 0.0);
        if (weights[i] == 0.0) {
            ASSERT_EQ(d.pmf(i), 0.0) << i;
        }
        sum += d.pmf(i);
        total += weights[i];
    }
    EXPECT_NEAR(double(sum), 1.0, 1e-12);
    EXPECT_NEAR(d.total() / double(total), 1.0, 1e-12);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        EXPECT_NEAR(d.pmf(i), double(weights[i] / total), 1e-12);
    }
    EXPECT_EQ(d.pmf(weights.size()), 0.0);

    // The realised probability: outcomes lie one behind the other, each as wide as its pmf.
    double edge = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double width = d.pmf(i);
        if (width > 1e-12) {
            for (const double share : {0.001, 0.5, 0.999}) {
                ASSERT_EQ(d.sample(edge + share * width).index, i);
            }
        }
        edge += width;
    }
    Rng rng(3, 0, StreamKind::User, weights.size());
    for (int k = 0; k < 2000; ++k) {
        const double u = k == 0 ? 0.0 : k == 1 ? kLast : rng.uniformDouble();
        const auto pick = d.sample(u);
        ASSERT_GT(weights[pick.index], 0.0);
        ASSERT_EQ(pick.pmf, d.pmf(pick.index));
        ASSERT_GT(pick.pmf, 0.0);
        ASSERT_TRUE(pick.remapped() >= 0.0 && pick.remapped() < 1.0);
    }
}

TEST(DiscreteDistribution, HardWeights) {
    const double denormal = std::numeric_limits<double>::denorm_min();
    const std::vector<std::vector<double>> cases{
        {1},
        {denormal},
        {1e308, 1e-308},
        {0, 0, 1},
        {1, 0, 0},
        {0, 1, 0, 0, 2, 0, 3, 0, 0},
        {denormal, denormal, denormal},
        {0, 3 * denormal, 0, denormal},
        {1e-30, 1e30, 1e-30},
        {1e30, 1, 1e-30, 0},
        {1e-30, 1, 1e30},
        std::vector<double>(1000, 1.0 / 3.0),
        std::vector<double>(4097, 1e-320),
    };
    for (std::size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE(i);
        checkInvariants(cases[i]);
    }
    stabilityCase("pmf-range", double(cases.size()), "sets of weights");
}

TEST(DiscreteDistribution, RandomWeightsOfAnyRange) {
    Random random(1);
    for (int round = 0; round < 60; ++round) {
        std::vector<double> weights;
        const int n = 1 + int(random.next() * 300);
        const double decades = 60 * random.real(), zeros = random.real();
        for (int i = 0; i < n; ++i) {
            weights.push_back(
                random.real() < zeros ? 0.0 : std::pow(10.0, decades * (random.real() - 0.5)));
        }
        weights[std::size_t(random.next() * float(n))] = 1.0;
        SCOPED_TRACE(round);
        checkInvariants(weights);
    }
    stabilityCase("pmf-range", 60, "sets of weights");
}

TEST(DiscreteDistribution, EmptyWhereNothingCanBePicked) {
    EXPECT_TRUE(DiscreteDistribution().empty());
    EXPECT_TRUE(DiscreteDistribution(std::vector<double>{}).empty());
    const DiscreteDistribution zeros(std::vector<double>(5, 0.0));
    EXPECT_TRUE(zeros.empty());
    EXPECT_EQ(zeros.size(), 5u);
    EXPECT_EQ(zeros.pmf(2), 0.0);
    EXPECT_EQ(DiscreteDistribution().pmf(0), 0.0);
    stabilityCase("pmf-of-nothing", zeros.pmf(2), "for a weight of zero");
}

TEST(DiscreteDistribution, RefusesWhatIsNoWeight) {
    const double inf = std::numeric_limits<double>::infinity();
    for (const double bad : {-1.0, -1e-300, std::nan(""), inf, -inf}) {
        const std::vector<double> weights{1.0, 2.0, bad, bad};
        try {
            DiscreteDistribution d(weights);
            FAIL() << bad;
        } catch (const std::invalid_argument& e) {
            EXPECT_NE(std::string(e.what()).find("weight 2 "), std::string::npos) << e.what();
        }
    }
}

TEST(DiscreteDistribution, FrequenciesAndRemappedNumber) {
    const std::vector<std::vector<double>> cases{
        {0, 1, 2, 3, 0, 4, 0}, {5}, std::vector<double>(100, 7.0), {1e-12, 1, 1e-3, 1e-2}};
    for (std::size_t c = 0; c < cases.size(); ++c) {
        const DiscreteDistribution d{cases[c]};
        Rng rng(21, 0, StreamKind::User, c);
        constexpr int kSamples = 200'000;
        std::vector<std::uint64_t> counts(d.size()), cells(20);
        for (int i = 0; i < kSamples; ++i) {
            const auto pick = d.sample(rng.uniformDouble());
            ++counts[pick.index];
            ++cells[std::size_t(pick.remapped() * 20)];
        }
        std::vector<double> pmf;
        for (std::size_t i = 0; i < d.size(); ++i) pmf.push_back(d.pmf(i));
        const double significance = sidak(kAlarm, kComparisons);
        EXPECT_GT(chiSquareSignificance(counts, pmf, kSamples), significance) << c;
        EXPECT_GT(chiSquareSignificance(cells, std::vector<double>(20, 0.05), kSamples),
                  significance)
            << c;
    }
}

TEST(DiscreteDistribution, RemappedNumberIsIndependentOfTheOutcome) {
    const DiscreteDistribution d(std::vector<double>{1, 2, 0, 3});
    Rng rng(22, 0, StreamKind::User, 0);
    constexpr int kSamples = 100'000;
    std::vector<std::uint64_t> counts(40);
    std::vector<double> expected(40);
    for (int i = 0; i < kSamples; ++i) {
        const auto pick = d.sample(rng.uniformDouble());
        ++counts[pick.index * 10 + std::size_t(pick.remapped() * 10)];
    }
    for (std::size_t i = 0; i < 40; ++i) expected[i] = d.pmf(i / 10) / 10;
    EXPECT_GT(chiSquareSignificance(counts, expected, kSamples), sidak(kAlarm, kComparisons));
}

TEST(DiscreteDistribution, TwentyMillionEntries) {
    // Serial float sums stick at 16,777,216 here.
    constexpr std::size_t kEntries = 20'000'000;
    const DiscreteDistribution d(std::vector<double>(kEntries, 1.0));
    EXPECT_DOUBLE_EQ(d.total(), double(kEntries));
    EXPECT_EQ(d.sample(kLast).index, kEntries - 1);
    EXPECT_EQ(d.sample(0.0).index, 0u);
    EXPECT_NEAR(d.pmf(kEntries - 1) * kEntries, 1.0, 1e-6);
    EXPECT_NEAR(d.pmf(kEntries / 2) * kEntries, 1.0, 1e-6);
    Rng rng(23, 0, StreamKind::User, 0);
    constexpr int kSamples = 200'000;
    std::vector<std::uint64_t> counts(200);
    for (int i = 0; i < kSamples; ++i) {
        const double u = rng.uniformDouble();
        const auto pick = d.sample(u);
        ASSERT_NEAR(pick.index, u * kEntries, 2.0);
        ++counts[pick.index / (kEntries / 200)];
    }
    EXPECT_GT(chiSquareSignificance(counts, std::vector<double>(200, 1.0 / 200), kSamples),
              sidak(kAlarm, kComparisons));
    stabilityCase("many-entries", std::fabs(d.pmf(kEntries - 1) * kEntries - 1.0),
                  "off the last entry's probability, relative");
}

}  // namespace
}  // namespace lacuna::test
