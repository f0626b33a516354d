// What streams are even with, and what they know nothing of. False alarms: 1e-3 over all comparisons
// of this file, for fixed seeds.
#include "libcore/bidir/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "tests/base/chi_square.h"

namespace lacuna::test {
namespace {

constexpr double kAlarm = 1e-3;
constexpr double kComparisons = 7;
constexpr std::uint32_t kGroup = 8, kSequence = 64;
constexpr std::uint64_t kBlock = 64;

const Sampler kSobol(Sampling::Sobol, 3, kBlock), kIndependent(Sampling::Independent, 3, kBlock);

std::vector<float> drawn(Rng rng, std::uint32_t dimension) {
    rng.toDimension(dimension);
    const auto [u1, u2] = rng.evenPair();
    const float one = rng.evenUniform();
    const double pick = rng.evenPick(1, 3);
    const Rng::Draw draw = rng.evenDraw();
    return {u1, u2, one, float(pick), float(draw.pick), draw.u1, draw.u2};
}

TEST(Sampler, independentStreamsAreThoseThatTheyAlwaysWere) {
    Rng plain(3, 5, StreamKind::EyePath, 17);
    const float u1 = plain.uniform(), u2 = plain.uniform(), one = plain.uniform();
    const double pick = plain.uniformDouble();
    const Rng::Draw draw = plain.draw();
    const std::vector<float> expected{u1, u2, one, float(pick), float(draw.pick), draw.u1, draw.u2};
    EXPECT_EQ(drawn(kIndependent.stream(5, StreamKind::EyePath, 17), 0), expected);
    // Beyond the even dimensions, and of kinds that have none, these are the numbers as well.
    EXPECT_EQ(drawn(kSobol.stream(5, StreamKind::EyePath, 17), 1000), expected);
    EXPECT_EQ(drawn(kSobol.stream(5, StreamKind::Warmup, 17), 0),
              drawn(kIndependent.stream(5, StreamKind::Warmup, 17), 0));
}

TEST(Sampler, aDimensionIsTheSameWhateverWasDrawnBefore) {
    Rng rng = kSobol.stream(5, StreamKind::LightPath, 17);
    const std::vector<float> first = drawn(rng, dimension::ofWalk(2));
    rng.uniform();
    rng.evenPair();
    EXPECT_EQ(drawn(rng, dimension::ofWalk(2)), first);
    EXPECT_NE(drawn(rng, dimension::ofWalk(3)), first);
}

TEST(Sampler, iterationsOfAGroupAreEven) {
    ASSERT_EQ(Sampler::groupOf(Sampling::Sobol), kGroup);
    ASSERT_EQ(Sampler::groupOf(Sampling::Independent), 1u);
    for (const StreamKind kind :
         {StreamKind::EyePath, StreamKind::LightPath, StreamKind::Connection}) {
        for (const std::uint32_t first : {0u, 8u, 48u, 64u, 6400u}) {
            std::set<int> squares, columns, picks;
            for (std::uint32_t i = first; i < first + kGroup; ++i) {
                Rng rng = kSobol.stream(i, kind, 9);
                rng.toDimension(dimension::ofPicks(4));
                const auto [u1, u2] = rng.evenPair();
                squares.insert(int(u1 * 4) * 2 + int(u2 * 2));
                columns.insert(int(u1 * 8));
                for (std::uint32_t n = 0; n < 4; ++n) picks.insert(int(rng.evenPick(n, 4) * 32));
            }
            EXPECT_EQ(squares.size(), 8u) << first;
            EXPECT_EQ(columns.size(), 8u) << first;
            EXPECT_EQ(picks.size(), 32u) << first;
        }
    }
}

TEST(Sampler, iterationsOfASequenceAreEven) {
    const Sampler endless(Sampling::Sobol, 3, 1 << 20);
    for (const std::uint32_t first : {0u, kSequence, 100 * kSequence}) {
        std::set<int> squares, columns;
        for (std::uint32_t i = first; i < first + kSequence; ++i) {
            const auto [u1, u2] = endless.stream(i, StreamKind::EyePath, 9).evenPair();
            squares.insert(int(u1 * 8) * 8 + int(u2 * 8));
            columns.insert(int(u1 * 64));
        }
        EXPECT_EQ(squares.size(), 64u) << first;
        EXPECT_EQ(columns.size(), 64u) << first;
    }
}

TEST(Sampler, aSequenceEndsWithItsBlock) {
    const Sampler twenty(Sampling::Sobol, 3, 20);
    const auto columns = [&](std::uint32_t first, std::uint32_t end) {
        std::set<int> seen;
        for (std::uint32_t i = first; i < end; ++i) {
            Rng rng = twenty.stream(i, StreamKind::EyePath, 9);
            seen.insert(int(rng.evenPair().u1 * float(end - first)));
        }
        return seen.size();
    };
    EXPECT_EQ(columns(0, 8), 8u);
    EXPECT_EQ(columns(16, 20), 4u);
    EXPECT_EQ(columns(20, 28), 8u);
}

/// Of pairs of numbers in 8 x 8 cells.
template <class Pair>
void expectIndependent(const char* what, const Pair& pair) {
    constexpr std::uint32_t kSamples = 40'000;
    std::vector<std::uint64_t> counts(64);
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        auto [a, b] = pair(i);
        ++counts[std::size_t(a.evenPair().u1 * 8) * 8 + std::size_t(b.evenPair().u1 * 8)];
    }
    EXPECT_GT(chiSquareSignificance(counts, std::vector<double>(64, 1.0 / 64), kSamples),
              sidak(kAlarm, kComparisons))
        << what;
}

TEST(Sampler, allElseIsIndependent) {
    const auto at = [](std::uint32_t iteration, StreamKind kind, std::uint64_t index) {
        return kSobol.stream(iteration, kind, index);
    };
    const StreamKind eye = StreamKind::EyePath;
    expectIndependent("sequences", [&](std::uint32_t i) {
        return std::pair(Sampler(Sampling::Sobol, 3, 1024).stream(3, eye, i),
                         Sampler(Sampling::Sobol, 3, 1024).stream(3 + kSequence, eye, i));
    });
    expectIndependent("blocks", [&](std::uint32_t i) {
        return std::pair(at(i % 8 + i / 8 * 128, eye, 1), at(i % 8 + i / 8 * 128 + 64, eye, 1));
    });
    expectIndependent("pixels",
                      [&](std::uint32_t i) { return std::pair(at(3, eye, i), at(3, eye, i + 1)); });
    expectIndependent("kinds", [&](std::uint32_t i) {
        return std::pair(at(3, eye, i), at(3, StreamKind::LightPath, i));
    });
    expectIndependent("picks", [&](std::uint32_t i) {
        return std::pair(at(3, eye, i), at(3, StreamKind::Connection, i));
    });
    expectIndependent("seeds", [&](std::uint32_t i) {
        return std::pair(at(3, eye, i), Sampler(Sampling::Sobol, 4, kBlock).stream(3, eye, i));
    });
    expectIndependent("dimensions", [&](std::uint32_t i) {
        Rng a = at(i % 8, eye, i / 8), b = a;
        b.toDimension(1);
        return std::pair(a, b);
    });
}

}  // namespace
}  // namespace lacuna::test
