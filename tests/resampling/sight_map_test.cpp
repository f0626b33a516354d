// What skeleton nodes can see.
#include "libcore/resampling/sight_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lacuna::test {
namespace {

/// Straight lines in a box around the origin without a lid (+z), with a ball in it.
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
    // A flat wall is never farther than the farthest of the four samples around it. The edges of
    // the box are, and 27 points are lost there. The ball's outline errs by a cell (0.03 to 0.06
    // rad), and only towards seeing too much.
    EXPECT_LT(unseen, kPoints / 400);
    EXPECT_EQ(sky, 0);
    EXPECT_LT(through, kPoints / 50);
    PathVertex here;
    here.kind = VertexKind::LightSource;
    here.position = origin;
    EXPECT_TRUE(map.sees(here));
}

}  // namespace
}  // namespace lacuna::test
