// Lamps that are sampled as balls: which lamps are, and that their points have the stated density. False alarms: 1e-3
// over all comparisons of this file.
#include "libcore/scene/ball_lamp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "libcore/scene/triangle.h"
#include "tests/base/chi_square.h"
#include "tests/scene/emissive_ball.h"
#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

constexpr double kBallSignificance = 1e-3 / 32;  // Sidak of fewer than 32 comparisons

Rng someNumbers(std::uint64_t seed) {
    return Rng(seed, 0, StreamKind::User, 0);
}

Vec3 someDirection(Rng& rng) {
    return normalize(Vec3{rng.uniform() - 0.5f, rng.uniform() - 0.5f, rng.uniform() - 0.5f});
}

/// A ball on its own.
class Ball {
  public:
    explicit Ball(Vec3 middle = {0.3f, -0.2f, 0.1f}, float radius = 0.5f, int rings = 12)
        : triangles(emissiveBall(middle, radius, rings)), lamp(BallLamp::find(triangles).at(0)) {}

    Vec3 at(const BallLamp::Point& p) const {
        const auto& [a, b, c] = triangles[p.light].corners;
        return a + (b - a) * p.uv.x + (c - a) * p.uv.y;
    }
    Vec3 normal(std::uint32_t light) const {
        const auto& [a, b, c] = triangles[light].corners;
        return triangleNormal(a, b, c);
    }
    /// Numerically, at the midpoints of 256 equal parts.
    double probability(std::uint32_t light, const Vec3& from) const {
        constexpr int kSteps = 16;
        const auto& [a, b, c] = triangles[light].corners;
        const Vec3d e1 = Vec3d(b - a), e2 = Vec3d(c - a);
        const double area = 0.5 * length(cross(e1, e2));
        double sum = 0.0;
        for (int i = 0; i < kSteps; ++i) {
            for (int j = 0; j < 2 * i + 1; ++j) {
                const double down = (i + (j % 2 ? 1.0 / 3.0 : 2.0 / 3.0)) / kSteps;
                const double across = (j / 2 + (j % 2 ? 2.0 / 3.0 : 1.0 / 3.0)) / kSteps;
                const Vec3 p(Vec3d(a) + e1 * (down - across) + e2 * across);
                sum += lamp.pdfA(from, p, normal(light));
            }
        }
        return sum * area / (kSteps * kSteps);
    }

    std::vector<EmissiveTriangle> triangles;
    BallLamp lamp;
};

TEST(BallLamp, ballsAreFoundAmongOtherLamps) {
    std::vector<EmissiveTriangle> all = emissiveBall({1, 2, 3}, 0.25f, 12);
    const std::size_t first = all.size();
    EmissiveTriangle flat = all[0];
    flat.corners = {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};
    all.push_back(flat);
    for (const EmissiveTriangle& t : emissiveBall({1, 2, 4}, 0.25f, 5)) all.push_back(t);
    const std::vector<BallLamp> found = BallLamp::find(all);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].lights().size() + found[1].lights().size(), 2u * 12 * 22 + 2u * 5 * 8);
    for (const BallLamp& ball : found) {
        const bool isFirst = ball.lights().front() < first;
        for (const std::uint32_t light : ball.lights()) EXPECT_EQ(light < first, isFirst);
    }
    EXPECT_TRUE(BallLamp::find({}).empty());
}

TEST(BallLamp, whatIsNoBallIsNotFound) {
    const auto isBall = [](const auto& change) {
        std::vector<EmissiveTriangle> triangles = emissiveBall({}, 1.0f, 12);
        change(triangles);
        return !BallLamp::find(triangles).empty();
    };
    using Triangles = std::vector<EmissiveTriangle>;
    EXPECT_TRUE(isBall([](Triangles&) {}));
    EXPECT_FALSE(isBall([](Triangles& t) {
        t.pop_back();
        t.erase(t.begin() + 100);
    })) << "open";
    EXPECT_FALSE(isBall([](Triangles& t) { t[100].radiance = Rgb(2.0f); }));
    EXPECT_FALSE(isBall([](Triangles& t) { t[100].material = 7; }));
    EXPECT_FALSE(isBall([](Triangles& t) {
        for (EmissiveTriangle& one : t) std::swap(one.corners[1], one.corners[2]);
    })) << "it shines inwards";
    EXPECT_FALSE(isBall([](Triangles& t) {
        for (EmissiveTriangle& one : t) {
            for (Vec3& c : one.corners) c.y *= 0.6f;
        }
    })) << "a lentil";
    EXPECT_FALSE(isBall([](Triangles& t) {
        const Vec3 from = t[100].corners[0];
        for (EmissiveTriangle& one : t) {
            for (Vec3& c : one.corners) {
                if (length(c - from) < 1e-3f) c = c * 0.9f;
            }
        }
    })) << "a dent";
    EXPECT_FALSE(isBall([](Triangles& t) {
        const Triangles once = t;
        t.insert(t.end(), once.begin(), once.end());
    })) << "two in one place";
    EXPECT_FALSE(isBall([](Triangles& t) {
        t = emissiveBall({1e6f, 0, 0}, 1.0f, 12);
    })) << "corners that floats know to a tenth of a radius";
}

TEST(BallLamp, pointsComeByTheirDensity) {
    Rng rng = someNumbers(41);
    constexpr std::uint64_t kDraws = 400'000;
    constexpr float kMostFactor = 4.0f;
    for (const int rings : {5, 12}) {
        const Ball ball({0.3f, -0.2f, 0.1f}, 0.5f, rings);
        for (const float distance : {0.3f, 0.55f, 0.7f, 2.0f, 1e4f}) {
            const Vec3 from = Vec3{0.3f, -0.2f, 0.1f} + someDirection(rng) * distance;
            std::vector<double> probabilities(ball.triangles.size());
            double hit = 0.0;
            for (const std::uint32_t l : ball.lamp.lights()) {
                const double probability = ball.probability(l, from);
                hit += probability;
                probabilities[l] = probability / double(kMostFactor);
            }
            EXPECT_NEAR(hit, 1.0, rings == 5 ? 0.1 : 0.02) << distance;
            std::vector<std::uint64_t> counts(ball.triangles.size());
            for (std::uint64_t n = 0; n < kDraws; ++n) {
                const double u = rng.uniformDouble();
                const float u1 = rng.uniform(), u2 = rng.uniform();
                const float kept = kMostFactor * rng.uniform();
                const auto point = ball.lamp.sample(from, u, u1, u2);
                if (!point) continue;
                ASSERT_LE(point->factor, kMostFactor);
                if (kept >= point->factor) continue;  // a factor counts as a chance
                ++counts[point->light];
                ASSERT_GT(ball.lamp.pdfA(from, ball.at(*point), ball.normal(point->light)), 0.0);
            }
            // The quadrature of pdfA is exact to 1e-3 where it varies most.
            EXPECT_GT(chiSquareSignificance(counts, probabilities, kDraws), kBallSignificance)
                << rings << " rings from " << distance;
        }
    }
}

// A sampled point is where its direction first meets the lamp: no other face is in front of it.
TEST(BallLamp, pointsAreThoseThatAreSeen) {
    const Ball ball;
    Rng rng = someNumbers(42);
    for (int n = 0; n < 2000; ++n) {
        const Vec3 to = someDirection(rng);
        const Vec3 from = Vec3{0.3f, -0.2f, 0.1f} + to * (0.51f + 3.0f * rng.uniform());
        const double u = rng.uniformDouble();
        const float u1 = rng.uniform(), u2 = rng.uniform();
        const auto point = ball.lamp.sample(from, u, u1, u2);
        if (!point) continue;
        EXPECT_GE(point->uv.x, 0.0f);
        EXPECT_GE(point->uv.y, 0.0f);
        EXPECT_LE(point->uv.x + point->uv.y, 1.0f);
        const Vec3d p(ball.at(*point)), d = p - Vec3d(from);
        for (const std::uint32_t l : ball.lamp.lights()) {
            const Vec3d normal(ball.normal(l)), a(ball.triangles[l].corners[0]);
            if (dot(normal, d) >= 0.0) continue;
            EXPECT_LE(dot(normal, a - Vec3d(from)) / dot(normal, d), 1.0 + 1e-4);
        }
    }
}

// The contribution of next event is the same for every point, except for the cosine at this end. If triangles were
// sampled instead, its relative variance would be .2.
TEST(BallLamp, everyPointBringsTheSame) {
    const std::vector<EmissiveTriangle> triangles = emissiveBall({}, 0.1f, 12);
    const Lights lights(triangles, {}, {}, nullptr, 2.0f);
    const Viewpoint from{{0.7f, -1.2f, 0.4f}, normalize(Vec3{-0.6f, 1.0f, -0.4f})};
    Rng rng = someNumbers(43);
    double sum = 0.0, squares = 0.0;
    constexpr int kDraws = 20'000;
    for (int n = 0; n < kDraws; ++n) {
        const Lights::SeenPoint seen = lights.sampleSeenPoint(from, rng);
        if (seen.samples == 0.0) continue;
        EXPECT_NEAR(seen.samples / lights.seenSamples(seen.point, from), 1.0, 1e-12);
        const Vec3 d = seen.point.position - from.position;
        const double cosine = -double(dot(seen.point.ng, normalize(d)));
        if (cosine <= 0.0) continue;
        const double brought = cosine * double(seen.factor) / double(dot(d, d)) /
                               (double(seen.point.pdf) * seen.samples);
        sum += brought;
        squares += brought * brought;
    }
    const double mean = sum / kDraws;
    EXPECT_LT(squares / kDraws / (mean * mean) - 1.0, 0.002) << "a single try at the rim: .02";
    // The solid angle of the polyhedron, about two hundredths below the ball's.
    const double sine2 = 0.01 / double(lengthSquared(from.position));
    const double ball = 2.0 * std::numbers::pi * sine2 / (1.0 + std::sqrt(1.0 - sine2));
    EXPECT_NEAR(mean / ball, 0.98, 0.015);
}

}  // namespace
}  // namespace lacuna::test
