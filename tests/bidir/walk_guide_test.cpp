// Guides of walks: squares of directions, regions, and the mixture that walks draw from. False alarms:
// 1e-6 for each comparison.
#include "libcore/bidir/walk_guide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "libcore/bidir/walk.h"
#include "tests/base/chi_square.h"
#include "tests/bidir/room.h"
#include "tests/fixtures/random_walk_guide.h"
#include "tests/scene/sphere_bins.h"

namespace lacuna::test {
namespace {

using Node = WalkGuide::Node;

TEST(DirectionSquare, IsThereAndBackAgain) {
    Rng rng(1, 0, StreamKind::User, 0);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 axis = randomDirection(rng), direction = randomDirection(rng);
        const bool both = i % 2 == 0;
        const DirectionSquare square(axis, both);
        const float cosine = dot(direction, axis);
        if (!both && cosine < 0.0f) {
            EXPECT_EQ(square.pdfW(direction), 0.0f);
            continue;
        }
        EXPECT_NEAR(square.pdfW(direction), std::fabs(cosine) * kInvPi * (both ? 0.5f : 1.0f),
                    1e-6f);
        const SquarePoint p = square.pointOf(direction);
        EXPECT_GE(std::min(p[0], p[1]), 0.0);
        EXPECT_LT(std::max(p[0], p[1]), 1.0);
        // Near the rim the sine squared knows a direction to the root of a float's rounding only.
        EXPECT_LT(length(square.directionAt(p) - direction), 1e-3f);
    }
}

TEST(DirectionSquare, DrawsWithTheDensityThatItTells) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        Rng rng(seed, 0, StreamKind::User, 1);
        WalkGuide::Region region;
        region.square = DirectionSquare(randomDirection(rng), seed % 2 == 0);
        for (WalkGuide::Field& f : region.fields) f = {0.5f, randomDensity(rng, 6)};
        for (const Side side : {Side::Light, Side::Eye}) {
            const SphereBins bins(region.square.axis(), 12, 12);
            auto mass = bins.integrate([&](Vec3 d) { return double(region.pdfW(side, d)); }, 48);
            double sum = 0;
            for (const double m : mass) sum += m;
            EXPECT_NEAR(sum, 1.0, 5e-3);
            for (double& m : mass) m /= sum;  // the quadrature's own error
            std::vector<std::uint64_t> counts(bins.size());
            constexpr int kDraws = 50'000;
            for (int i = 0; i < kDraws; ++i) {
                ++counts[bins.find(region.sample(side, rng.uniform(), rng.uniform()))];
            }
            EXPECT_GT(chiSquareSignificance(counts, mass, kDraws), 1e-6) << "seed " << seed;
        }
    }
}

/// A walk draws by BSDF, guide, and a delta event beside them: the densities that it stores must be those.
TEST(WalkGuide, WalksGoOnWithTheDensityThatIsToldOfThem) {
    const auto scene = room(4);
    const Camera camera = scene->makeCamera("", {4, 4}, {});
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const Walker walker(*scene, {nullptr, randomWalkGuide(seed)}, camera, {8, 8});
        Rng rng(seed, 0, StreamKind::User, 2);
        std::vector<PathVertex> path;
        RayTally tally;
        int judged = 0;
        for (int i = 0; i < 4000; ++i) {
            walker.traceEye({4.0f * rng.uniform(), 4.0f * rng.uniform()}, rng, tally, path);
            for (std::size_t n = 1; n + 1 < path.size(); ++n) {
                const PathVertex &v = path[n], &next = path[n + 1];
                if (next.infinite() || n < 2) continue;
                ASSERT_NE(v.region, kNone);
                EXPECT_EQ(v.region, walker.guide()->regionAt(WalkGuide::placeOf(v)));
                const BsdfEvaluation e =
                    walker.scattering(v, v.toPrevious, -next.toPrevious, v.event);
                const double d2 = double(lengthSquared(Vec3d(next.position) - Vec3d(v.position)));
                const double expected =
                    double(e.pdfWToLight) * std::fabs(double(dot(next.ng, next.toPrevious))) / d2;
                ASSERT_NEAR(next.pdfA, expected, 1e-3 * expected);
                ASSERT_NEAR(path[n - 1].pdfReverseA,
                            double(e.pdfWToEye) * double(v.toPreviousFactor),
                            1e-4 * double(path[n - 1].pdfReverseA));
                ++judged;
            }
        }
        EXPECT_GT(judged, 4000);
    }
}

TEST(WalkGuide, LeavesDeltaEventsTheirShare) {
    const auto guide = randomWalkGuide(3);
    BsdfEvaluation e;
    e.pdfWToLight = e.pdfWToEye = 2.0f;
    std::uint32_t region = 0;
    while (guide->region(region).of(Side::Eye).share == 0.0f) ++region;
    guide->mix(region, {0, 0, 1}, {0, 0, 1}, ScatterEvent::DeltaReflection, e);
    EXPECT_FLOAT_EQ(e.pdfWToLight, 2.0f * (1.0f - guide->region(region).of(Side::Eye).share));
    EXPECT_FLOAT_EQ(e.pdfWToEye, 2.0f * (1.0f - guide->region(region).of(Side::Light).share));
}

TEST(WalkGuide, OfOneSideLeavesTheOtherAlone) {
    const auto guide = randomWalkGuide(4);
    const WalkGuide eyes = guide->of(Side::Eye);
    for (std::size_t i = 0; i < eyes.regions().size(); ++i) {
        EXPECT_EQ(eyes.regions()[i].of(Side::Light).share, 0.0f);
        EXPECT_EQ(eyes.regions()[i].of(Side::Eye).share, guide->regions()[i].of(Side::Eye).share);
    }
    EXPECT_NE(eyes.contentHash(), guide->contentHash());
}

TEST(WalkGuide, RefusesWhatIsNoTree) {
    const WalkGuide::Region even{DirectionSquare({0, 0, 1}, false), {}};
    const auto refused = [&](std::vector<Node> nodes, std::vector<WalkGuide::Region> regions) {
        EXPECT_THROW(WalkGuide(std::move(nodes), std::move(regions)), std::invalid_argument);
    };
    const std::vector<Node> good(WalkGuide::kKinds);
    EXPECT_NO_THROW(WalkGuide(good, {even}));
    refused({}, {even});
    refused(good, {});  // no such region
    const auto with = [&](std::initializer_list<Node> more, Node first) {
        std::vector<Node> nodes = good;
        nodes.insert(nodes.end(), more);
        nodes[0] = first;
        return nodes;
    };
    const Node leaf{};
    const auto inner = [](std::uint32_t number, std::uint32_t child, float threshold = 0.0f) {
        return Node{threshold, WalkGuide::kInner | number << WalkGuide::kNumberShift | child};
    };
    EXPECT_NO_THROW(WalkGuide(with({leaf, leaf}, inner(5, 4)), {even}));
    refused(with({leaf, leaf}, inner(6, 4)), {even});  // no such number
    refused(with({leaf, leaf}, inner(0, 0)), {even});  // its own child
    refused(with({leaf, leaf}, inner(0, 5)), {even});  // half of it missing
    refused(with({leaf, leaf}, leaf), {even});         // nodes without a parent
    refused(with({leaf, leaf}, inner(0, 4, std::nanf(""))), {even});
    refused(with({inner(0, 4), leaf}, inner(0, 4)), {even});  // two parents
    WalkGuide::Region wild = even;
    wild.fields[0].share = 1.0f;
    refused(good, {wild});  // leaves nothing to the BSDF
    wild = even;
    wild.square = DirectionSquare({0, 0, 2}, false);
    refused(good, {wild});
}

}  // namespace
}  // namespace lacuna::test
