// Which numbers of streams are even together, and which are independent. False alarms: 1e-3 over all comparisons of
// this file, for fixed seeds.
#include "libcore/bidir/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "tests/base/chi_square.h"

namespace lacuna::test {
namespace {

constexpr double kAlarm = 1e-3;
constexpr double kComparisons = 5;
constexpr std::uint32_t kGroup = 8;

const Sampler kSobol(Sampling::Sobol, 3), kIndependent(Sampling::Independent, 3);

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
    // Beyond the even dimensions, and for kinds that have none, streams of the sequence give the same numbers.
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

TEST(Sampler, allIterationsAreEven) {
    for (const std::uint32_t count : {64u, 4096u}) {
        const std::uint32_t side = count == 64 ? 8 : 64;
        for (const std::uint32_t first : {0u, 3 * count}) {
            std::set<std::uint32_t> squares, columns;
            for (std::uint32_t i = first; i < first + count; ++i) {
                const auto [u1, u2] = kSobol.stream(i, StreamKind::EyePath, 9).evenPair();
                squares.insert(std::uint32_t(u1 * float(side)) * side +
                               std::uint32_t(u2 * float(side)));
                columns.insert(std::uint32_t(u1 * float(count)));
            }
            EXPECT_EQ(squares.size(), count) << first;
            EXPECT_EQ(columns.size(), count) << first;
        }
    }
}

/// Expects pairs of numbers to be independent, in 8 x 8 cells.
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
    expectIndependent("pixels",
                      [&](std::uint32_t i) { return std::pair(at(3, eye, i), at(3, eye, i + 1)); });
    expectIndependent("kinds", [&](std::uint32_t i) {
        return std::pair(at(3, eye, i), at(3, StreamKind::LightPath, i));
    });
    expectIndependent("picks", [&](std::uint32_t i) {
        return std::pair(at(3, eye, i), at(3, StreamKind::Connection, i));
    });
    expectIndependent("seeds", [&](std::uint32_t i) {
        return std::pair(at(3, eye, i), Sampler(Sampling::Sobol, 4).stream(3, eye, i));
    });
    expectIndependent("dimensions", [&](std::uint32_t i) {
        Rng a = at(i % 8, eye, i / 8), b = a;
        b.toDimension(1);
        return std::pair(a, b);
    });
}

}  // namespace
}  // namespace lacuna::test
