// Alias tables: they draw with the probabilities that they report.
#include "libcore/base/alias_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "libcore/base/rng.h"

namespace lacuna::test {
namespace {

constexpr double kInside = 1e-10;  // of a slot: its border may round into the next slot

/// The probabilities that a table draws with, to kInside of a slot. Bisection finds where each
/// slot's second outcome begins.
std::vector<double> realised(const AliasTable& table) {
    const auto n = double(table.size());
    std::vector<double> mass(table.size(), 0.0);
    for (std::size_t k = 0; k < table.size(); ++k) {
        const double begin = double(k) / n, end = double(k + 1) / n;
        double low = begin + kInside / n, high = end - kInside / n;
        const std::uint32_t first = table.sample(low).index, second = table.sample(high).index;
        if (first == second) {
            mass[first] += end - begin;
            continue;
        }
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            (table.sample(middle).index == first ? low : high) = middle;
        }
        mass[first] += high - begin;
        mass[second] += end - high;
    }
    return mass;
}

void check(const std::vector<double>& weights) {
    const AliasTable table{weights};
    ASSERT_EQ(table.size(), weights.size());
    ASSERT_FALSE(table.empty());
    double total = 0, largest = 0;
    for (const double w : weights) largest = std::max(largest, w);
    for (const double w : weights) total += w / largest;
    EXPECT_NEAR(table.total() / largest, total, 1e-12 * total);
    const std::vector<double> mass = realised(table);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double pmf = weights[i] / largest / total;
        EXPECT_NEAR(table.pmf(i), pmf, 1e-7 * pmf + 1e-37) << i;
        EXPECT_NEAR(mass[i], pmf, 1e-6 * pmf + 2 * kInside / double(weights.size())) << i;
        if (weights[i] == 0.0) {
            EXPECT_EQ(mass[i], 0.0) << i;
        }
    }
    Rng rng(5, 0, StreamKind::User, weights.size());
    for (int k = 0; k < 2000; ++k) {
        const double u = k == 0 ? 0.0 : k == 1 ? std::nextafter(1.0, 0.0) : rng.uniformDouble();
        table.prefetch(u);
        const AliasTable::Pick pick = table.sample(u);
        ASSERT_LT(pick.index, weights.size());
        ASSERT_GT(weights[pick.index], 0.0);
        ASSERT_EQ(pick.pmf, table.pmf(pick.index));
        ASSERT_TRUE(pick.remapped >= 0.0 && pick.remapped < 1.0) << pick.remapped;
    }
}

TEST(AliasTable, RealisesItsPmf) {
    check({1});
    check({0, 3});
    check({3, 0, 0, 0});
    check({1, 1, 1, 1, 1, 1, 1});
    check({1e-12, 1, 2, 0, 5, 1e-3, 0});
    Rng rng(1, 0, StreamKind::User, 0);
    for (const double spread : {1.0, 10.0, 60.0}) {  // weights over so many powers of e
        for (const std::size_t n : {2u, 33u, 1000u, 4097u}) {
            std::vector<double> weights(n);
            for (double& w : weights) w = std::exp(spread * rng.uniformDouble());
            for (std::size_t i = 0; i < n; i += 7) weights[i] = 0.0;
            weights[n - 1] = 1.0;
            check(weights);
        }
    }
}

TEST(AliasTable, AnyRangeAndAnySum) {
    const double huge = std::numeric_limits<double>::max();
    check({0.3 * huge, 0.3 * huge, 0.1 * huge});
    check({1e-300, 2e-300, 1e-300});
    check({4e-324, 4e-324});
}

TEST(AliasTable, TheRemappedNumberIsUniform) {
    const AliasTable table{std::vector<double>{0.1, 3, 1, 0.4}};
    constexpr int kDraws = 200000, kBins = 16;
    std::vector<int> bins(kBins, 0);
    Rng rng(2, 0, StreamKind::User, 0);
    for (int i = 0; i < kDraws; ++i) {
        ++bins[std::size_t(table.sample(rng.uniformDouble()).remapped * kBins)];
    }
    double chi2 = 0;
    for (const int b : bins)
        chi2 += std::pow(b - kDraws / double(kBins), 2) / (kDraws / double(kBins));
    EXPECT_LT(chi2, 44.3);  // 15 degrees of freedom, false alarm 1e-4
}

TEST(AliasTable, NothingToPick) {
    EXPECT_TRUE(AliasTable().empty());
    EXPECT_TRUE(AliasTable(std::vector<double>{}).empty());
    const AliasTable zeros(std::vector<double>{0, 0, 0});
    EXPECT_TRUE(zeros.empty());
    EXPECT_EQ(zeros.total(), 0.0);
    // For the sanitizers: there is no slot to point at.
    AliasTable().prefetch(0.7);
    zeros.prefetch(0.7);
}

TEST(AliasTable, BadWeightsAreNamed) {
    for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        try {
            AliasTable table(std::vector<double>{1, bad});
            ADD_FAILURE() << bad;
        } catch (const std::invalid_argument& e) {
            EXPECT_NE(std::string(e.what()).find("weight 1"), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace lacuna::test
