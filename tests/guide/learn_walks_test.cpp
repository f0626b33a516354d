// Guided walks against directions that are known to be best.
#include "libcore/guide/learn_walks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/base/sampling.h"

namespace lacuna::test {
namespace {

const ThreadPool& twoThreads() {
    static const ThreadPool threads(2);
    return threads;
}

/// Steps of diffuse surfaces that found their directions by the cosine: a floor and a wall. `carries`
/// (place's numbers, direction in the surface's frame) gives what they contribute.
struct PlantedSteps {
    WalkSamples train, heldOut;
};
template <class Carries>
PlantedSteps plantSteps(int count, const Carries& carries, bool delta = false) {
    PlantedSteps p;
    Rng rng(1, 0, StreamKind::User, 0);
    for (int i = 0; i < count; ++i) {
        const Vec3 normal = rng.below(2) == 0 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
        const Vec3 local = cosineHemisphere(rng.uniform(), rng.uniform());
        WalkSamples::Step s{};
        s.place = {0, {rng.uniform(), rng.uniform(), rng.uniform(), normal.x, normal.y, normal.z}};
        s.to = Frame(normal).toWorld(local);
        s.weight = 1.0f;
        s.pdfBsdf = s.pdfFound = kInvPi * local.z;
        s.side = rng.below(2) == 0 ? Side::Eye : Side::Light;
        s.delta = delta;
        const auto contribution = float(carries(s, local, rng));
        if (!(contribution > 0.0f)) continue;
        (i % 10 == 0 ? p.heldOut : p.train).put(std::uint32_t(i), contribution, {&s, 1});
    }
    return p;
}

/// The mean density, over that of the cosine, of directions within a cone about `axis`.
double gainAround(const WalkGuide& guide, const WalkGuide::Place& place, Side side,
                  const Vec3& axis) {
    const WalkGuide::Region& region = guide.region(guide.regionAt(place));
    const Vec3 normal(place.numbers[3], place.numbers[4], place.numbers[5]);
    const double share = double(region.of(side).share);
    double sum = 0;
    for (int i = 0; i < 100; ++i) {
        const Vec3 near = cosineHemisphere(float(i % 10 + 0.5) / 10, float(i / 10 + 0.5) / 10);
        const Vec3 d = normalize(axis + 0.1f * near);
        const double even = double(kInvPi * std::max(0.0f, dot(d, normal)));
        sum += (1 - share) + share * double(region.pdfW(side, d)) / even;
    }
    return sum / 100;
}

TEST(LearnWalks, FindsWhereLightComesFromByPlaceAndWall) {
    // A lamp takes 1 in 12 of the cosine's directions: another one on the left, on the right, and from the wall. Light
    // walks find the camera elsewhere.
    const Vec3 left = normalize(Vec3{-1, 0, 1}), right = normalize(Vec3{0, 1, 1}),
               fromWall = normalize(Vec3{1, -1, 0}), camera = normalize(Vec3{0.2f, -1, 1});
    const auto axisOf = [&](const WalkSamples::Step& s) {
        if (s.side == Side::Light) return s.place.numbers[3] > 0.5f ? fromWall : camera;
        return s.place.numbers[3] > 0.5f ? fromWall : s.place.numbers[0] < 0.5f ? left : right;
    };
    const PlantedSteps p = plantSteps(400'000, [&](const WalkSamples::Step& s, const Vec3&, Rng&) {
        return dot(s.to, axisOf(s)) > 0.94f ? 1.0 : 0.0;
    });
    const LearnedWalks learned = learnWalks(p.train, p.heldOut, twoThreads());
    ASSERT_TRUE(learned.guide);
    for (const Side side : {Side::Light, Side::Eye}) {
        // A guide that knew the lamp's rim would reach .09 with the largest share.
        EXPECT_LT(learned.heldOutLoss[std::size_t(side)], 0.3);
    }
    const auto gain = [&](float x, const Vec3& n, Side side, const Vec3& axis) {
        return gainAround(*learned.guide, {0, {x, 0.5f, 0.5f, n.x, n.y, n.z}}, side, axis);
    };
    const Vec3 up{0, 0, 1}, out{1, 0, 0};
    EXPECT_GT(gain(0.2f, up, Side::Eye, left), 4.0);
    EXPECT_LT(gain(0.2f, up, Side::Eye, right), 0.5);
    EXPECT_GT(gain(0.8f, up, Side::Eye, right), 4.0);
    EXPECT_LT(gain(0.8f, up, Side::Eye, left), 0.5);
    EXPECT_GT(gain(0.5f, out, Side::Eye, fromWall), 4.0);
    EXPECT_GT(gain(0.2f, up, Side::Light, camera), 4.0);
    EXPECT_LT(gain(0.2f, up, Side::Light, left), 0.5);
}

TEST(LearnWalks, LeavesBsdfsAloneWhereTheyAreAsGood) {
    const auto same = [](const WalkSamples::Step&, const Vec3&, Rng&) { return 1.0; };
    const auto wild = [](const WalkSamples::Step&, const Vec3&, Rng& rng) {
        return 1.0 / (1e-3 + rng.uniformDouble());
    };
    for (const PlantedSteps& p :
         {plantSteps(50, same), plantSteps(50'000, same), plantSteps(20'000, wild)}) {
        const LearnedWalks learned = learnWalks(p.train, p.heldOut, twoThreads());
        EXPECT_GT(learned.heldOutLoss[0], 0.95);
        EXPECT_GT(learned.heldOutLoss[1], 0.95);
    }
    EXPECT_FALSE(learnWalks({}, {}, twoThreads()).guide);
}

/// Light that only delta events make is no reason to go elsewhere.
TEST(LearnWalks, LeavesMirrorsAlone) {
    const PlantedSteps p = plantSteps(
        50'000, [](const WalkSamples::Step&, const Vec3&, Rng&) { return 1.0; }, true);
    const LearnedWalks learned = learnWalks(p.train, p.heldOut, twoThreads());
    EXPECT_GE(learned.heldOutLoss[0], 1.0);
    EXPECT_FALSE(learned.guide);
}

/// Steps that were found by another density count as if the BSDF had found them.
TEST(LearnWalks, KnowsWhatItsStepsWereFoundWith) {
    PlantedSteps p;
    Rng rng(3, 0, StreamKind::User, 0);
    for (int i = 0; i < 200'000; ++i) {
        // One half of the directions comes three times as often as the other, so that each step there stands for a
        // third.
        const bool often = rng.below(4) != 0;
        const Vec3 local = cosineHemisphere(rng.uniform(), rng.uniform());
        WalkSamples::Step s{};
        s.place = {0, {rng.uniform(), rng.uniform(), rng.uniform(), 0, 0, 1}};
        s.to = {often ? std::fabs(local.x) : -std::fabs(local.x), local.y, local.z};
        s.weight = 1.0f;
        s.pdfBsdf = kInvPi * local.z;
        s.pdfFound = s.pdfBsdf * (often ? 1.5f : 0.5f);
        s.side = Side::Eye;
        (i % 10 == 0 ? p.heldOut : p.train)
            .put(std::uint32_t(i), 1.0f / (often ? 1.5f : 0.5f), {&s, 1});
    }
    EXPECT_GT(learnWalks(p.train, p.heldOut, twoThreads()).heldOutLoss[std::size_t(Side::Eye)],
              0.98);
}

TEST(LearnWalks, IsTheSameForAnyNumberOfThreads) {
    const PlantedSteps p = plantSteps(20'000, [](const WalkSamples::Step&, const Vec3& local,
                                                 Rng&) { return double(local.x * local.x); });
    const ThreadPool one(1);
    const LearnedWalks a = learnWalks(p.train, p.heldOut, one),
                       b = learnWalks(p.train, p.heldOut, twoThreads());
    ASSERT_TRUE(a.guide && b.guide);
    EXPECT_EQ(a.guide->contentHash(), b.guide->contentHash());
}

TEST(TechniqueWorth, IsThatOfTheRow) {
    const TechniqueWorth pt = TechniqueWorth::of({.hits = true, .connects = true});
    EXPECT_EQ(pt(6, 5), 1.0);
    EXPECT_EQ(pt(5, 5), 1.0);
    EXPECT_EQ(pt(4, 5), 0.0) << "no light subpath";
    EXPECT_EQ(pt(1, 5), 0.0);
    const TechniqueWorth pooled =
        TechniqueWorth::of({.hits = true, .connects = true, .splats = true});
    EXPECT_EQ(pooled(4, 5), 100.0);
    EXPECT_EQ(pooled(1, 5), 1.0);
    const TechniqueWorth bpt =
        TechniqueWorth::of({.hits = true, .connects = true, .splats = true, .ownLightPath = true});
    EXPECT_EQ(bpt(4, 5), 1.0);
}

}  // namespace
}  // namespace lacuna::test
