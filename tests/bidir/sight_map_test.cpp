// What skeleton nodes see, and that skelbpt's weights believe what its selector does with it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libcore/base/parallel.h"
#include "libcore/methods/methods.h"
#include "libcore/methods/sight_map.h"
#include "libcore/skeleton/node_map.h"
#include "tests/bidir/beliefs.h"
#include "tests/bidir/finite_space.h"

namespace lacuna::test {
namespace {

/// Straight lines in a box about the origin without a lid (+z), with a ball in it.
class OpenBox final : public PathSpace {
  public:
    static constexpr float kHalf[3] = {1, 2, 3};
    static constexpr float kBallRadius = 0.5f;
    const Vec3 ballCentre{0.2f, -1.0f, -1.5f};

    void traceEye(Rng&, RayTally&, std::vector<PathVertex>&) const override {}
    Arrival arrival(Subpath, Subpath, bool) const override { return {}; }
    bool visible(const PathVertex&, const PathVertex&, RayTally&) const override { return false; }
    float reach(const Vec3& origin, const Vec3& direction, RayTally&) const override {
        float nearest = std::numeric_limits<float>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            const float d = direction[axis];
            if (d == 0.0f || (axis == 2 && d > 0.0f)) continue;
            nearest = std::min(nearest, (std::copysign(kHalf[axis], d) - origin[axis]) / d);
        }
        const Vec3 to = ballCentre - origin;
        const float along = dot(to, direction);
        const float inside = along * along - lengthSquared(to) + kBallRadius * kBallRadius;
        if (along > 0.0f && inside > 0.0f) nearest = std::min(nearest, along - std::sqrt(inside));
        return nearest;
    }
};

Vec3 randomDirection(Rng& rng) {
    const float z = 2.0f * rng.uniform() - 1.0f, phi = 6.2831853f * rng.uniform();
    const float r = std::sqrt(1.0f - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

TEST(SightMap, seesAsFarAsRaysDo) {
    const OpenBox box;
    RayTally tally;
    const Vec3 origin{-0.3f, 0.4f, 0.5f};
    const SightMap map(origin, box, tally);
    Rng rng(31, 0, StreamKind::CachePath, 0);
    constexpr int kPoints = 20000;
    int unseen = 0, through = 0, sky = 0;
    for (int i = 0; i < kPoints; ++i) {
        const Vec3 direction = randomDirection(rng);
        const float reach = box.reach(origin, direction, tally);
        PathVertex y;
        if (std::isinf(reach)) {
            y.kind = VertexKind::Infinite;
            y.position = direction;
            sky += !map.sees(y);
            continue;
        }
        y.kind = VertexKind::LightSource;
        y.position = origin + direction * reach;
        unseen += !map.sees(y);
        y.position = origin + direction * (1.5f * reach);
        through += map.sees(y);
    }
    // A flat wall is no farther than the farthest of four points around; in the box's edges, which
    // are, 27 points are lost. The ball's outline errs by a cell (0.03 to 0.06 rad), and only
    // towards seeing too much.
    EXPECT_LT(unseen, kPoints / 400);
    EXPECT_EQ(sky, 0);
    EXPECT_LT(through, kPoints / 50);
    PathVertex here;
    here.kind = VertexKind::LightSource;
    here.position = origin;
    EXPECT_TRUE(map.sees(here));
}

/// The finite space's eye paths in front of a wall at x = 1 that hides what lies behind it.
class BehindAWall final : public PathSpace {
  public:
    void traceEye(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const override {
        space_.traceEye(rng, tally, out);
    }
    Arrival arrival(Subpath, Subpath, bool) const override { return {}; }
    bool visible(const PathVertex& light, const PathVertex&, RayTally&) const override {
        return light.position.x <= 1.0f;
    }
    float reach(const Vec3& origin, const Vec3& direction, RayTally&) const override {
        return direction.x > 0.0f ? (1.0f - origin.x) / direction.x
                                  : std::numeric_limits<float>::infinity();
    }

  private:
    FiniteSpace space_{3};
};

/// One node for everything.
std::shared_ptr<const Skeleton> oneNode() {
    const VoxelShape shape{{1, 1, 1}, {-8, -8, -8}, 16};
    auto skeleton = std::make_shared<Skeleton>();
    skeleton->nodes = {{{0, 0, 0}, 1}};
    skeleton->map = NodeMap(shape, {0});
    return skeleton;
}

// Where every iteration has the same pool, the frozen means are this pool's, and the choice by mass
// is what the belief is exact for: r = 1 / (1/M + (1 - 1/M) / R) with R = M P(y), seen or not.
TEST(SightMap, skelbptBelievesWhatItPicks) {
    constexpr int kSubpaths = 6;
    const LightPool pool = poolOfPairs(kSubpaths, [](int i, PathVertex& y) {
        y.position = {i % 2 == 0 ? 0.9f : 2.0f + 0.3f * float(i), 0.4f * float(i), 0.1f};
        // What is hidden is bright: taken for seen it would be believed to be picked often.
        y.throughput = Rgb((i % 2 == 0 ? 1.0f : 20.0f) * float(1 + i * i));
    });
    const BehindAWall space;
    const ThreadPool threads(1);
    IterationStatistics statistics;
    IterationContext context{space, threads, 41, 1000, statistics};
    const MethodRow row = skeletonRow();
    const std::vector<std::string> settings = {"candidates=6", "choice=mass", "node_acceptance=0"};
    const auto method = row.create(resolve(row, settings));
    method->useSkeleton(oneNode());
    const ConnectionDensity& density = settle(*method, pool, context, 2);

    std::vector<PathVertex> eye;
    RayTally tally;
    Rng rng(42, 0, StreamKind::EyePath, 0);
    do {
        space.traceEye(rng, tally, eye);
    } while (eye.size() < 2 || !eye[1].connectable());
    const auto found =
        beliefs(*method, density, {eye.data(), 2}, kSubpaths, 1.0,
                [](const PathVertex& y) { return std::size_t(std::lround(y.position.y / 0.4f)); });
    for (std::size_t i = 0; i < kSubpaths; ++i) {
        ASSERT_GT(found[i].picked, 0.0) << i;
        EXPECT_NEAR(found[i].believed / found[i].picked, 1.0, 1e-6) << i;
    }
}

}  // namespace
}  // namespace lacuna::test
