// Streams of random numbers. False alarms: 1e-3 over all comparisons of this file.
#include "libcore/base/rng.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "tests/base/chi_square.h"

namespace lacuna::test {
namespace {

constexpr double kAlarm = 1e-3;
constexpr double kComparisons = 12;

std::vector<std::uint32_t> draw(Rng rng, int n) {
    std::vector<std::uint32_t> values;
    for (int i = 0; i < n; ++i) values.push_back(rng.bits());
    return values;
}

TEST(Rng, StreamDoesNotDependOnOrder) {
    std::vector<std::vector<std::uint32_t>> forward, backward(50);
    for (int i = 0; i < 50; ++i)
        forward.push_back(draw({7, 3, StreamKind::EyePath, unsigned(i)}, 9));
    for (int i = 49; i >= 0; --i) {
        backward[i] = draw({7, 3, StreamKind::EyePath, unsigned(i)}, 9);
    }
    EXPECT_EQ(forward, backward);
}

TEST(Rng, PhiloxAgainstPublishedVector) {
    // Random123's kat_vectors for philox4x32, all zero, seven rounds.
    const std::vector<std::uint32_t> seven{0x5f6fb709, 0x0d893f64, 0x4f121f81, 0x4f730a48};
    EXPECT_EQ(draw({0, 0, StreamKind::LightPath, 0}, 4), seven);
}

TEST(Rng, ADrawIsADoubleAndTwoFloatsOfTheStream) {
    for (int before = 0; before < 9; ++before) {
        Rng one(3, 1, StreamKind::User, 5), other = one;
        for (int i = 0; i < before; ++i) EXPECT_EQ(one.bits(), other.bits());
        for (int i = 0; i < 3; ++i) {
            const Rng::Draw d = one.draw();
            EXPECT_EQ(d.pick, other.uniformDouble());
            EXPECT_EQ(d.u1, other.uniform());
            EXPECT_EQ(d.u2, other.uniform());
        }
        EXPECT_EQ(one.bits(), other.bits());
    }
}

TEST(Rng, EveryPartOfTheAddressMakesAStream) {
    std::set<std::vector<std::uint32_t>> seen;
    std::size_t streams = 0;
    for (const std::uint64_t seed : {0ull, 1ull, 1ull << 32, 0xffffffffffffffffull}) {
        for (const std::uint32_t iteration : {0u, 1u, 0xffffffffu}) {
            for (int kind = 0; kind <= int(StreamKind::CacheDraw); ++kind) {
                for (const std::uint64_t index : {0ull, 1ull, 255ull, 256ull, 1ull << 31,
                                                  1ull << 32, 1ull << 33, (1ull << 56) - 1}) {
                    seen.insert(draw({seed, iteration, StreamKind(kind), index}, 4));
                    ++streams;
                }
            }
        }
    }
    EXPECT_EQ(seen.size(), streams);
    // Blocks of one stream do not come back in another.
    std::set<std::uint32_t> words;
    for (std::uint64_t index = 0; index < 100; ++index) {
        for (const std::uint32_t w : draw({1, 0, StreamKind::User, index}, 40)) words.insert(w);
    }
    EXPECT_GE(words.size(), 3990u);  // 4000 words collide about 0.002 times
}

TEST(Rng, UniformStaysBelowOne) {
    Rng rng(1, 0, StreamKind::User, 0);
    float low = 1, high = 0;
    Moments mean, meanDouble;
    for (int i = 0; i < 1'000'000; ++i) {
        const float u = rng.uniform();
        ASSERT_TRUE(u >= 0.0f && u < 1.0f);
        low = std::min(low, u);
        high = std::max(high, u);
        mean.add(u);
        const double d = rng.uniformDouble();
        ASSERT_TRUE(d >= 0.0 && d < 1.0);
        meanDouble.add(d);
    }
    EXPECT_LT(low, 2e-5f);
    EXPECT_GT(high, 1 - 2e-5f);
    const double significance = sidak(kAlarm, kComparisons);
    for (const Moments& m : {mean, meanDouble}) {
        EXPECT_GT(normalTail(std::abs(m.mean() - 0.5) / m.standardError(), 2), significance);
    }
}

TEST(Rng, BelowIsUniform) {
    int stream = 0;
    for (const std::uint32_t n : {1u, 2u, 3u, 7u, 64u, 1000u}) {
        Rng rng(11, 0, StreamKind::User, unsigned(stream++));
        constexpr int kSamples = 100'000;
        std::vector<std::uint64_t> counts(n);
        for (int i = 0; i < kSamples; ++i) {
            const std::uint32_t k = rng.below(n);
            ASSERT_LT(k, n);
            ++counts[k];
        }
        EXPECT_GT(chiSquareSignificance(counts, std::vector<double>(n, 1.0 / n), kSamples),
                  sidak(kAlarm, kComparisons))
            << n;
    }
    Rng rng(12, 0, StreamKind::User, 0);
    for (int i = 0; i < 1000; ++i) ASSERT_LT(rng.below(0xffffffffu), 0xffffffffu);
}

TEST(Rng, NeighbouringStreamsAreIndependent) {
    // Pairs of numbers in 8 x 8 cells: of neighbouring streams, kinds and iterations, and of one
    // stream.
    std::vector<std::uint64_t> across(64), along(64), kinds(64), iterations(64);
    constexpr unsigned kSamples = 50'000;
    const auto cell = [](float a, float b) { return unsigned(a * 8) * 8 + unsigned(b * 8); };
    for (unsigned i = 0; i < kSamples; ++i) {
        Rng a(5, 0, StreamKind::LightPath, i), b(5, 0, StreamKind::LightPath, i + 1),
            c(5, 0, StreamKind::EyePath, i), d(5, 1, StreamKind::LightPath, i);
        const float u = a.uniform();
        ++across[cell(u, b.uniform())];
        ++kinds[cell(u, c.uniform())];
        ++iterations[cell(u, d.uniform())];
        ++along[cell(u, a.uniform())];
    }
    for (const auto* counts : {&across, &along, &kinds, &iterations}) {
        EXPECT_GT(chiSquareSignificance(*counts, std::vector<double>(64, 1.0 / 64), kSamples),
                  sidak(kAlarm, kComparisons));
    }
}

}  // namespace
}  // namespace lacuna::test
