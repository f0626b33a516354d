// Maps from the unit square, and frames. False alarms: 1e-3 over all comparisons of this file.
#include "libcore/base/sampling.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "libcore/base/rng.h"
#include "tests/base/chi_square.h"

namespace lacuna::test {
namespace {

constexpr double kAlarm = 1e-3;
constexpr double kComparisons = 2;
constexpr float kLast = 0x1.fffffep-1f;

void checkFrame(Vec3 n) {
    const Frame f(n);
    EXPECT_EQ(f.n, n);
    for (const Vec3& v : {f.s, f.t}) {
        EXPECT_NEAR(length(Vec3d(v)), 1.0, 5e-7);
        EXPECT_NEAR(dot(Vec3d(v), Vec3d(n)), 0.0, 5e-7);
    }
    EXPECT_NEAR(dot(Vec3d(f.s), Vec3d(f.t)), 0.0, 5e-7);
    EXPECT_NEAR(dot(cross(Vec3d(f.s), Vec3d(f.t)), Vec3d(n)), 1.0, 1e-6);
    const Vec3 local{0.3f, -0.5f, 0.8f};
    EXPECT_LT(length(f.toLocal(f.toWorld(local)) - local), 1e-6f);
    EXPECT_LT(length(f.toWorld(Vec3{0, 0, 1}) - n), 1e-7f);
}

TEST(Frame, OrthonormalEverywhere) {
    for (const float s : {1.0f, -1.0f}) {
        checkFrame({s, 0, 0});
        checkFrame({0, s, 0});
        checkFrame({0, 0, s});
        checkFrame({0, 1, s * 0.0f});
        for (const float tilt : {1e-38f, 1e-20f, 1e-8f, 1e-4f, 1e-3f}) {
            checkFrame(normalize(Vec3{tilt, 0, s}));
            checkFrame(normalize(Vec3{-tilt, tilt, s}));
            checkFrame(normalize(Vec3{1, 0, s * tilt}));
        }
    }
    Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const double z = 2 * random.real() - 1, phi = 2 * std::numbers::pi * random.real();
        const double r = std::sqrt(1 - z * z);
        checkFrame(Vec3(Vec3d{r * std::cos(phi), r * std::sin(phi), z}));
    }
}

/// The concentric map in double, straight from the paper.
Vec3d exactDisk(double u1, double u2) {
    const double a = 2 * u1 - 1, b = 2 * u2 - 1;
    if (a == 0 && b == 0) return {};
    const bool aLonger = std::abs(a) > std::abs(b);
    const double r = aLonger ? a : b;
    const double phi = aLonger ? std::numbers::pi / 4 * (b / a)
                               : std::numbers::pi / 2 - std::numbers::pi / 4 * (a / b);
    return {r * std::cos(phi), r * std::sin(phi), 0};
}

TEST(ConcentricDisk, MatchesTheExactMap) {
    Random random(2);
    const auto check = [](float u1, float u2) {
        const Vec2 p = concentricDisk(u1, u2);
        const Vec3d e = exactDisk(u1, u2);
        ASSERT_NEAR(p.x, e.x, 2e-7) << u1 << " " << u2;
        ASSERT_NEAR(p.y, e.y, 2e-7) << u1 << " " << u2;
        ASSERT_LE(p.x * p.x + p.y * p.y, 1 + 4e-7f);
    };
    for (const float u1 : {0.0f, 0.25f, 0.5f, 0.75f, kLast}) {
        for (const float u2 : {0.0f, 0.25f, 0.5f, 0.75f, kLast}) check(u1, u2);
    }
    for (int i = 0; i < 20'000; ++i) check(random.next(), random.next());
    EXPECT_EQ(concentricDisk(0.5f, 0.5f), (Vec2{0, 0}));
}

TEST(Turns, SineAndCosineAreExactToFloatPrecision) {
    Random random(3);
    const auto check = [](float turns) {
        const double angle = 2 * std::numbers::pi * double(turns);
        const SineCosine found = sineCosineOfTurns(turns);
        ASSERT_NEAR(found.sine, std::sin(angle), 2e-7) << turns;
        ASSERT_NEAR(found.cosine, std::cos(angle), 2e-7) << turns;
    };
    for (int eighth = -16; eighth <= 16; ++eighth) check(float(eighth) / 8);
    for (int i = 0; i < 20'000; ++i) check(3 * random.next() - 1.5f);
    EXPECT_EQ(sineCosineOfTurns(0.0f).sine, 0.0f);
    EXPECT_EQ(sineCosineOfTurns(0.5f).cosine, -1.0f);
}

TEST(Turns, ArctangentInAllQuadrants) {
    const auto check = [](float y, float x) {
        const double exact = std::atan2(double(y), double(x)) / (2 * std::numbers::pi);
        ASSERT_NEAR(turnsOf(y, x), exact, 6e-8) << y << " " << x;
    };
    for (const float y : {-1.0f, -0.5f, 0.0f, 0.5f, 1.0f}) {
        for (const float x : {-1.0f, -0.5f, 0.0f, 0.5f, 1.0f}) check(y, x);
    }
    Random random(4);
    for (int i = 0; i < 20'000; ++i) {
        const float scale = std::exp2(120 * random.next() - 60);  // any length
        check(scale * (2 * random.next() - 1), scale * (2 * random.next() - 1));
    }
    EXPECT_EQ(turnsOf(0.0f, 0.0f), 0.0f);
    EXPECT_EQ(turnsOf(1e-30f, 1.0f), 1e-30f / (2 * kPi));
}

TEST(ConcentricDisk, AreaIsPreserved) {
    constexpr int kSamples = 200'000;
    std::vector<std::uint64_t> counts(8 * 16);  // rings of equal area x sectors
    Rng rng(1, 0, StreamKind::User, 0);
    for (int i = 0; i < kSamples; ++i) {
        const float u1 = rng.uniform();
        const Vec2 p = concentricDisk(u1, rng.uniform());
        const double ring = std::min(7.0, 8.0 * (double(p.x) * p.x + double(p.y) * p.y));
        const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi) + 0.5;
        ++counts[std::size_t(ring) * 16 + std::min(15u, unsigned(turn * 16))];
    }
    EXPECT_GT(chiSquareSignificance(counts, std::vector<double>(128, 1.0 / 128), kSamples),
              sidak(kAlarm, kComparisons));
}

TEST(CosineHemisphere, DensityIsCosineOverPi) {
    constexpr int kSamples = 200'000;
    std::vector<std::uint64_t> counts(10 * 12);  // equal steps of z: mass z^2
    std::vector<double> expected(counts.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        expected[i] = (2.0 * double(i / 12) + 1) / 1200;
    Rng rng(1, 0, StreamKind::User, 1);
    for (int i = 0; i < kSamples; ++i) {
        const float u1 = rng.uniform();
        const Vec3 v = cosineHemisphere(u1, rng.uniform());
        ASSERT_GE(v.z, 0.0f);
        ASSERT_NEAR(length(Vec3d(v)), 1.0, 4e-7);
        const double turn = std::atan2(v.y, v.x) / (2 * std::numbers::pi) + 0.5;
        ++counts[std::min(9u, unsigned(v.z * 10)) * 12 + std::min(11u, unsigned(turn * 12))];
    }
    EXPECT_GT(chiSquareSignificance(counts, expected, kSamples), sidak(kAlarm, kComparisons));
    for (const float u1 : {0.0f, 0.5f, kLast}) {
        for (const float u2 : {0.0f, 0.5f, kLast}) {
            const Vec3 v = cosineHemisphere(u1, u2);
            EXPECT_TRUE(isFinite(v) && v.z >= 0.0f);
        }
    }
}

}  // namespace
}  // namespace lacuna::test
