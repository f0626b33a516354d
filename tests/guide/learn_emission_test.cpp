// Learned emission against densities that are known to be best.
#include "libcore/guide/learn_emission.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "tests/scene/scene_builder.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

/// Two lamps of equal power: a square's two triangles.
Lights twoLamps() {
    std::vector<EmissiveTriangle> triangles(2);
    triangles[0].corners = {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}};
    triangles[1].corners = {Vec3{0, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}};
    for (EmissiveTriangle& t : triangles) t.radiance = Rgb(1.0f);
    return Lights(triangles, {}, {}, nullptr, 4.0f);
}

const ThreadPool& pool() {
    static const ThreadPool threads(2);
    return threads;
}

/// Paths found under plain emission, evenly over both squares. `carries` (light, point, ray) gives
/// what they contribute.
struct Planted {
    EmissionSamples train, heldOut;
};
template <class Carries>
Planted plant(int count, const Carries& carries, std::uint64_t seed = 1) {
    Planted p;
    Rng rng(seed, 0, StreamKind::User, 0);
    const auto number = [&] { return rng.uniformDouble(); };
    for (int i = 0; i < count; ++i) {
        EmissionSamples::Sample s{};
        s.light = rng.below(2);
        s.pixel = std::uint32_t(i);
        s.point = {number(), number()};
        s.ray = {number(), number()};
        s.contribution = float(carries(s.light, s.point, s.ray, rng));
        s.withRay = s.pdfPoint = s.pdfRay = 1.0f;
        if (s.contribution > 0.0f) (i % 10 == 0 ? p.heldOut : p.train).put(s);
    }
    return p;
}

TEST(LearnEmission, FindsWhereLightLeavesFor) {
    const Lights lights = twoLamps();
    // A hole: an eighth by a quarter of the rays of one lamp get through, 1 in 64 in all.
    const auto through = [](std::uint32_t light, SquarePoint, SquarePoint ray, Rng&) {
        return light == 1 && ray[0] < 0.125 && ray[1] >= 0.75 ? 1.0 : 0.0;
    };
    const Planted p = plant(400'000, through);
    const LearnedEmission learned = learnEmission(lights, p.train, p.heldOut, pool());
    ASSERT_TRUE(learned.guide);
    learned.guide->check(2);
    // A mixture with a tenth of plain emission can have .1 + .9 * 64 times its density there.
    EXPECT_NEAR(learned.heldOutLoss, 1.0 / 57.7, 0.1 / 57.7);
    EXPECT_EQ(learned.plainShare, 0.1);
    EXPECT_NEAR(learned.guide->pmf[1], 0.95, 0.01);
    const EmissionGuide::Here here = learned.guide->at(1, {0.5, 0.5});
    ASSERT_TRUE(here.rays);
    double inHole = 0, low = 1e9, high = 0;
    for (int i = 0; i < 256; ++i) {
        const double pdf =
            here.rays->at({0.125 * (i % 16 + 0.5) / 16, 0.75 + 0.25 * (i / 16 + 0.5) / 16}).pdf;
        inHole += pdf / 256;
        low = std::min(low, pdf);
        high = std::max(high, pdf);
    }
    EXPECT_NEAR(inHole, 0.1 + 0.9 * 32, 0.6);
    EXPECT_GT(low, 10.0) << "what few samples say of the hole's parts is not believed";
    EXPECT_LT(high, 60.0);
    EXPECT_NEAR(here.rays->at({0.6, 0.2}).pdf, 0.1, 0.03);
}

TEST(LearnEmission, SharesByTheRootOfTheSecondMoment) {
    const Lights lights = twoLamps();
    // From the upper half of a lamp's points, one path in nine carries nine times as much: the same
    // light, nine times the second moment, and so three times the paths.
    const Planted p = plant(400'000, [](std::uint32_t, SquarePoint point, SquarePoint, Rng& rng) {
        return point[0] < 0.5 ? 1.0 : rng.below(9) == 0 ? 9.0 : 0.0;
    });
    const LearnedEmission learned = learnEmission(lights, p.train, p.heldOut, pool());
    ASSERT_TRUE(learned.guide);
    const double plain = learned.plainShare;
    for (const std::uint32_t light : {0u, 1u}) {
        EXPECT_NEAR(learned.guide->pmf[light], 0.5, 0.02);
        EXPECT_NEAR(learned.guide->at(light, {0.8, 0.5}).pdf, plain + (1 - plain) * 1.5, 0.1);
        EXPECT_NEAR(learned.guide->at(light, {0.2, 0.5}).pdf, plain + (1 - plain) * 0.5, 0.1);
    }
}

/// A light that is one point has no points to learn.
TEST(LearnEmission, DividesNoLightWithoutExtent) {
    const Lights lights({}, std::vector<PunctualLight>{pointLight({}, Rgb(1.0f))}, {}, nullptr,
                        4.0f);
    Planted p;
    Rng rng(1, 0, StreamKind::User, 0);
    for (int i = 0; i < 20'000; ++i) {
        EmissionSamples::Sample s{};
        s.pixel = std::uint32_t(i);
        s.ray = {0.25 * rng.uniformDouble(), rng.uniformDouble()};
        s.contribution = s.withRay = s.pdfPoint = s.pdfRay = 1.0f;
        (i % 10 == 0 ? p.heldOut : p.train).put(s);
    }
    const LearnedEmission learned = learnEmission(lights, p.train, p.heldOut, pool());
    ASSERT_TRUE(learned.guide);
    EXPECT_EQ(learned.guide->points.at(0).leafCount(), 1u);
    LightPlace place;
    place.light = 0;
    EXPECT_EQ(lights.guidedBy(learned.guide).guidedPdfs(place, {0, 0, 1}, {}).point, 1.0f);
    EXPECT_NEAR(learned.heldOutLoss, 1.0 / (0.1 + 0.9 * 4), 0.02);
}

/// Lights without power get exactly zero, despite rounding.
TEST(LearnEmission, GivesNothingToLightsWithoutPower) {
    std::vector<EmissiveTriangle> triangles(4);
    for (std::size_t i = 0; i < 4; ++i) {
        triangles[i].corners = {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}};
        triangles[i].radiance = Rgb(i % 2 == 0 ? 1.0f : 0.0f);
    }
    const Lights lights(triangles, {}, {}, nullptr, 4.0f);
    double furthest = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Rng rng(seed, 0, StreamKind::User, 0);
        Planted p;
        for (int i = 0; i < 2000; ++i) {
            EmissionSamples::Sample s{};
            s.light = rng.below(3) == 0 ? 2 : 0;
            s.pixel = std::uint32_t(i);
            s.point = {rng.uniformDouble(), rng.uniformDouble()};
            s.ray = {0.1 * rng.uniformDouble(), rng.uniformDouble()};
            s.contribution = s.withRay = s.pdfPoint = s.pdfRay = 1.0f;
            (i % 10 == 0 ? p.heldOut : p.train).put(s);
        }
        const LearnedEmission learned = learnEmission(lights, p.train, p.heldOut, pool());
        ASSERT_TRUE(learned.guide);
        learned.guide->check(4);
        for (const std::size_t dark : {1u, 3u}) {
            furthest = std::max(furthest, std::abs(learned.guide->pmf[dark]));
        }
    }
    EXPECT_EQ(furthest, 0.0);
    stabilityCase("learned-dark-lamps", furthest, "for a lamp without power");
}

/// Paths that were found under a guide count as if they had been found without one.
TEST(LearnEmission, KnowsWhatItsPathsWereFoundWith) {
    const Lights lights = twoLamps();
    // Half of the square's rays are found three times as often as the others: each of them stands
    // for a third as much.
    Planted p;
    Rng rng(3, 0, StreamKind::User, 0);
    for (int i = 0; i < 200'000; ++i) {
        EmissionSamples::Sample s{};
        s.light = rng.below(2);
        s.pixel = std::uint32_t(i);
        s.point = {rng.uniformDouble(), rng.uniformDouble()};
        const bool often = rng.below(4) != 0;  // 3/4 of the rays into half of the square
        s.ray = {0.5 * rng.uniformDouble() + (often ? 0.0 : 0.5), rng.uniformDouble()};
        s.pdfRay = often ? 1.5f : 0.5f;
        s.contribution = 1.0f / s.pdfRay;
        s.withRay = s.pdfPoint = 1.0f;
        (i % 10 == 0 ? p.heldOut : p.train).put(s);
    }
    // All rays carry the same: plain emission is best.
    const LearnedEmission learned = learnEmission(lights, p.train, p.heldOut, pool());
    EXPECT_GT(learned.heldOutLoss, 0.99);
}

TEST(LearnEmission, LeavesAloneWhatCannotBeBettered) {
    const Lights lights = twoLamps();
    const auto same = [](std::uint32_t, SquarePoint, SquarePoint, Rng&) { return 1.0; };
    const auto wild = [](std::uint32_t, SquarePoint, SquarePoint, Rng& rng) {
        return 1.0 / (1e-3 + rng.uniformDouble());
    };
    const Planted few = plant(50, same), many = plant(50'000, same), noise = plant(20'000, wild);
    for (const Planted* p : {&few, &many, &noise}) {
        EXPECT_GT(learnEmission(lights, p->train, p->heldOut, pool()).heldOutLoss, 0.9);
    }
    EXPECT_FALSE(learnEmission(lights, {}, {}, pool()).guide);
    const Lights none({}, {}, {}, nullptr, 4.0f);
    EXPECT_FALSE(learnEmission(none, {}, {}, pool()).guide);
}

TEST(LearnEmission, IsTheSameForAnyNumberOfThreads) {
    const Lights lights = twoLamps();
    const Planted p = plant(
        20'000, [](std::uint32_t, SquarePoint, SquarePoint ray, Rng&) { return ray[0] * ray[0]; });
    const ThreadPool one(1);
    const LearnedEmission a = learnEmission(lights, p.train, p.heldOut, one),
                          b = learnEmission(lights, p.train, p.heldOut, pool());
    ASSERT_TRUE(a.guide && b.guide);
    EXPECT_EQ(a.guide->contentHash(), b.guide->contentHash());
}

}  // namespace
}  // namespace lacuna::test
