// E(mu, alpha) compared with independent Monte Carlo, and the identities that conservation of
// energy rests on.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "libcore/base/sampling.h"
#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf.h"
#include "libcore/material/fresnel.h"
#include "tests/material/statistics.h"

namespace lacuna::test {
namespace {

/// E, estimated by sampling normals from D cos (not the visible ones): [Walter07 eq 35, 41] with
/// the textbook's G2.
Moments monteCarloAlbedo(double mu, double alpha, double ior, int samples, Random& random) {
    const auto lambda = [&](double c) {
        return (std::sqrt(1 + alpha * alpha * (1 / (c * c) - 1)) - 1) / 2;
    };
    const double sine = std::sqrt(1 - mu * mu);
    Moments m;
    for (int i = 0; i < samples; ++i) {
        const double u = random.real(), phi = 2 * std::numbers::pi * random.real();
        const double tangent = alpha * std::sqrt(u / (1 - u));
        const double hz = 1 / std::sqrt(1 + tangent * tangent), hs = hz * tangent;
        const double vh = sine * hs * std::cos(phi) + mu * hz;
        const double co = 2 * vh * hz - mu;
        double weight = 0;
        if (vh > 0 && co > 0) {
            weight = fresnelDielectric(vh, ior) * vh / (1 + lambda(mu) + lambda(co)) / (mu * hz);
        }
        m.add(weight);
    }
    return m;
}

void checkTable(float ior, int points, int samples, std::uint64_t seed, double significance) {
    const AlbedoTable table(ior);
    Random random(seed);
    for (int i = 0; i < points; ++i) {
        // Angles up to 89.99 degrees, as far as the estimator's variance allows (mu not much less
        // than alpha).
        const float alpha = float(std::pow(1e-4, random.real()));
        const float low = std::max(2e-4f, 0.03f * alpha);
        const float mu = i % 2 == 0 ? float(low * std::pow(1 / double(low), random.real()))
                                    : 0.05f + 0.95f * random.next();
        const Moments m = monteCarloAlbedo(double(mu), double(alpha), double(ior), samples, random);
        const double e = double(table.directional(AlbedoTable::positionOf(alpha), mu));
        const double excess = std::max(0.0, std::abs(e - m.mean()) - double(kTableError));
        EXPECT_GT(normalTail(excess / std::max(1e-9, m.standardError()), 2), significance)
            << "ior " << ior << " mu " << mu << " alpha " << alpha << ": " << e << " " << m.mean()
            << " +- " << m.standardError();
    }
}

TEST(AlbedoTables, AgreeWithMonteCarlo) {
    for (const float ior : {1.05f, 1.5f, 2.5f}) {
        checkTable(ior, 40, 20000, 31, sidak(1e-3, 120));
    }
}
TEST(AlbedoTablesSlow, AgreeWithMonteCarlo) {
    for (const float ior : {1.01f, 1.1f, 1.33f, 1.5f, 2.0f, 3.0f}) {
        checkTable(ior, 150, 200000, 32, sidak(1e-3, 900));
    }
}

TEST(AlbedoTables, AverageIsTheIntegralOfWhatIsLookedUp) {
    for (const float ior : {1.0f, 1.01f, 1.5f, 3.0f}) {
        const AlbedoTable table(ior);
        for (const float alpha : {1e-4f, 3e-3f, 0.0123f, 0.2f, 0.77f, 1.0f}) {
            const AlbedoTable::AlphaPosition position = AlbedoTable::positionOf(alpha);
            double sum = 0;
            constexpr int kSteps = 200000;
            for (int i = 0; i < kSteps; ++i) {
                // mu = t^2 resolves the horizon.
                const double t = (i + 0.5) / kSteps;
                sum += double(table.directional(position, float(t * t))) * 4 * t * t * t / kSteps;
            }
            EXPECT_NEAR(double(table.average(position)), sum, 2e-6) << ior << " " << alpha;
            EXPECT_GE(table.directional(position, 0.0f), 0.0f);
            EXPECT_LE(table.directional(position, 1.0f + 1e-6f), 1.0f);
        }
    }
}

TEST(AlbedoTables, ClosedFormOfTheSmoothAverage) {
    for (const double n : {1.00001, 1.001, 1.1, 1.5, 3.0, 20.0, 1e4}) {
        double sum = 0;
        constexpr int kSteps = 400000;
        for (int i = 0; i < kSteps; ++i) {
            const double t = (i + 0.5) / kSteps;
            sum += fresnelDielectric(t * t, n) * 4 * t * t * t / kSteps;
        }
        EXPECT_NEAR(fresnelAverage(n), sum, 1e-6) << n;
    }
    EXPECT_EQ(fresnelAverage(1.0), 0.0);
}

TEST(AlbedoTables, LookUpAndDeterminism) {
    const std::array<float, 4> iors{1.5f, 1.33f, 1.5f, 1.8f};
    const AlbedoTables a(iors), b(iors);
    ASSERT_TRUE(a.find(1.33f));
    EXPECT_FALSE(a.find(1.4f));
    EXPECT_EQ(a.covering(1.4f), a.find(1.5f));
    EXPECT_EQ(a.covering(1.5f), a.find(1.5f));
    EXPECT_EQ(a.covering(2.0f), a.find(1.8f));
    EXPECT_EQ(AlbedoTables().covering(1.5f), nullptr);
    EXPECT_EQ(clearcoatTable().ior(), Bsdf::kClearcoatIor);
    for (int i = 0; i < 1000; ++i) {
        const AlbedoTable::AlphaPosition position = AlbedoTable::positionOf(float(i) / 999);
        const float mu = float((i * 37) % 1000) / 999;
        EXPECT_EQ(a.find(1.5f)->directional(position, mu), b.find(1.5f)->directional(position, mu));
    }
}

TEST(Sampling, DiskAndFrame) {
    Random random(33);
    double r2 = 0;
    constexpr int kSamples = 100000;
    for (int i = 0; i < kSamples; ++i) {
        const float u1 = random.next(), u2 = random.next();
        const Vec2 p = concentricDisk(u1, u2);
        ASSERT_LE(p.x * p.x + p.y * p.y, 1 + 1e-6f);
        r2 += double(p.x * p.x + p.y * p.y);
        const Vec3 n = normalize(Vec3{u1 - 0.5f, u2 - 0.5f, random.next() - 0.5f});
        const Frame f(n);
        ASSERT_NEAR(dot(cross(f.s, f.t), n), 1, 1e-5);
        ASSERT_NEAR(dot(f.s, f.t), 0, 1e-5);
        const Vec3 v = cosineHemisphere(u1, u2);
        ASSERT_NEAR(length(v), 1, 1e-6);
        ASSERT_LT(length(f.toLocal(f.toWorld(v)) - v), 1e-5f);
    }
    EXPECT_NEAR(r2 / kSamples, 0.5, 0.005);  // 5.5 standard errors
}

}  // namespace
}  // namespace lacuna::test
