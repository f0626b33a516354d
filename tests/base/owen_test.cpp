// Even points. False alarms: 1e-3 over all comparisons of this file, for fixed seeds.
#include "libcore/base/owen.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "libcore/base/rng.h"
#include "tests/base/chi_square.h"

namespace lacuna::test {
namespace {

constexpr double kAlarm = 1e-3;
constexpr double kComparisons = 13;

/// Whether each box of every shape 2^-a x 2^-(m-a) has one of the 2^m points.
testing::AssertionResult isNet(const std::vector<OwenPair>& points, int m) {
    for (int a = 0; a <= m; ++a) {
        std::set<std::uint64_t> boxes;
        for (const OwenPair& p : points) {
            const std::uint64_t x = std::uint64_t(p.x) >> (32 - a);
            boxes.insert(x << (m - a) | std::uint64_t(p.y) >> (32 - m + a));
        }
        if (boxes.size() != points.size()) {
            return testing::AssertionFailure() << "boxes of 2^-" << a << " x 2^-" << m - a;
        }
    }
    return testing::AssertionSuccess();
}

std::vector<OwenPair> pointsFrom(std::uint32_t first, int m, std::uint64_t seed) {
    std::vector<OwenPair> points;
    for (std::uint32_t i = 0; i < 1u << m; ++i) points.push_back(owenPair(first + i, seed));
    return points;
}

TEST(Owen, reversedBitsComeBack) {
    EXPECT_EQ(reverseBits(1), 0x80000000u);
    EXPECT_EQ(reverseBits(0x00f1a2c4), 0x23458f00u);
    for (const std::uint32_t x : {0u, 1u, 0x12345678u, 0xffffffffu, 0x80000001u}) {
        EXPECT_EQ(reverseBits(reverseBits(x)), x);
    }
}

TEST(Owen, theSecondDimensionIsSobols) {
    // By its direction numbers: 1, 3, 5, 15, 17, 51, .. (each bit of the index that is set
    // contributes one).
    std::uint32_t directions[32] = {0x80000000u};
    for (int i = 1; i < 32; ++i) directions[i] = directions[i - 1] ^ directions[i - 1] >> 1;
    Rng rng(1, 0, StreamKind::User, 0);
    for (int n = 0; n < 1000; ++n) {
        const std::uint32_t index = n < 500 ? std::uint32_t(n) : rng.bits();
        std::uint32_t expected = 0;
        for (int i = 0; i < 32; ++i) {
            if (index >> i & 1) expected ^= directions[i];
        }
        EXPECT_EQ(reverseBits(sobolSecondReversed(index)), expected) << index;
    }
}

TEST(Owen, everyRunOfAPowerOfTwoIsANet) {
    for (const int m : {0, 1, 2, 3, 4, 6, 10}) {
        for (const std::uint64_t seed : {0ull, 1ull, 77ull, 0xffffffffffffffffull}) {
            for (const std::uint32_t run : {0u, 1u, 5u, 1000u}) {
                EXPECT_TRUE(isNet(pointsFrom(run << m, m, seed), m)) << m << " " << seed;
            }
        }
    }
}

TEST(Owen, aNumberIsEvenAlone) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        std::set<std::uint32_t> cells;
        for (std::uint32_t i = 0; i < 64; ++i) cells.insert(owenNumber(128 + i, seed) >> 26);
        EXPECT_EQ(cells.size(), 64u) << seed;
    }
}

/// The significance of kSamples draws in 8 x 8 cells.
template <class Draw>
double evenness(const Draw& draw) {
    constexpr std::uint32_t kSamples = 50'000;
    std::vector<std::uint64_t> counts(64);
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const auto [a, b] = draw(i);
        ++counts[(a >> 29) * 8 + (b >> 29)];
    }
    return chiSquareSignificance(counts, std::vector<double>(64, 1.0 / 64), kSamples);
}

TEST(Owen, aSinglePointIsUniformOverSeeds) {
    const double significance = sidak(kAlarm, kComparisons);
    for (const std::uint32_t index : {0u, 1u, 6u, 15u}) {
        EXPECT_GT(evenness([&](std::uint32_t seed) {
                      const OwenPair p = owenPair(index, mixBits(seed));
                      return std::pair(p.x, p.y);
                  }),
                  significance)
            << index;
        // The bits below those that boxes of few points depend on.
        EXPECT_GT(evenness([&](std::uint32_t seed) {
                      const OwenPair p = owenPair(index, mixBits(seed));
                      return std::pair(p.x << 12, p.y << 12);
                  }),
                  significance)
            << index;
    }
}

TEST(Owen, sequencesKnowNothingOfEachOther) {
    const double significance = sidak(kAlarm, kComparisons);
    constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;
    // The same point of two seeds that are neighbours, or that differ by the step between
    // dimensions.
    for (const std::uint64_t apart : {std::uint64_t(1), std::uint64_t(2), kStep}) {
        EXPECT_GT(evenness([&](std::uint32_t seed) {
                      return std::pair(owenPair(3, seed).x, owenPair(3, seed + apart).x);
                  }),
                  significance)
            << apart;
    }
    // Two dimensions of one seed, over points: their orders are scrambled as well.
    EXPECT_GT(evenness([&](std::uint32_t i) {
                  return std::pair(owenPair(i % 64, mixBits(i / 64)).x,
                                   owenNumber(i % 64, mixBits(i / 64) + kStep));
              }),
              significance);
    EXPECT_GT(evenness([&](std::uint32_t i) {
                  return std::pair(owenPair(i % 16, mixBits(i / 16)).y,
                                   owenPair(i % 16, mixBits(i / 16) + kStep).y);
              }),
              significance);
}

}  // namespace
}  // namespace lacuna::test
