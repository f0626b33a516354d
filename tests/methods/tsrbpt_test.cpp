// Two-stage resampling: that the weights believe what the second stage does.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/parallel.h"
#include "libcore/methods/registry.h"
#include "tests/fixtures/beliefs.h"
#include "tests/fixtures/fixed_eye_path.h"

namespace lacuna::test {
namespace {

/// One eye path from above to a surface at the origin. Light vertices arrive with their throughput
/// and one G, and are seen but for those next to the origin.
class OneSurface final : public FixedEyePath {
  public:
    static constexpr double kGeometry = 1e-3;  // less than any light vertex really has

    OneSurface() {
        Bsdf::Parameters p;
        p.baseColor = Rgb(0.5f);
        addLens({0, 1, 2});
        addSurface({0, 0, 0}, p);
    }
    Arrival arrival(Subpath light, Subpath, bool) const override {
        return {light.back().throughput, {}, kGeometry};
    }
    bool visible(const PathVertex& light, const PathVertex&, RayTally&) const override {
        return length(light.position) > 0.01f;
    }
};

// Where every iteration has the same pool and a cluster is a vertex, Q2 is this pool's, and what
// the second stage gives a vertex beyond its reserve is what the belief is exact for:
// n r = 1 / (1/M1 + (1 - 1/M1) w), w the weight of the pick. The reserve goes to the vertex next to
// the surface: without its share 1 - d the belief would be 1 / (1 - d) times too high.
TEST(TwoStageWeights, believeWhatTheSecondStagePicks) {
    constexpr int kSubpaths = 6;
    const LightPool pool = poolOfPairs(kSubpaths, [](int i, PathVertex& y) {
        y.position = i == 0 ? Vec3{0, 0, 1e-4f} : Vec3{0.4f * float(i), 0, 1.5f};
        y.throughput = Rgb(float(1 + i * i));
    });
    const OneSurface space;
    const ThreadPool threads(1);
    const MethodRow& row = findMethod("tsrbpt");
    for (const char* defensive : {"defensive=0.25", "defensive=0.7"}) {
        SCOPED_TRACE(defensive);
        IterationStatistics statistics;
        IterationContext context{space, threads, 41, 1, statistics};
        const std::vector<std::string> settings = {"candidates=6", "second_candidates=1000000",
                                                   "cache_density=1", defensive};
        const auto method = row.create(resolve(row, settings));
        const ConnectionDensity& density = settle(*method, pool, context, 3);
        const auto found = beliefs(
            *method, density, space.eye(), kSubpaths, OneSurface::kGeometry,
            [](const PathVertex& y) { return std::size_t(std::lround(y.position.x / 0.4f)); });
        for (std::size_t i = 1; i < kSubpaths; ++i) {
            ASSERT_GT(found[i].picked, 0.0) << i;
            EXPECT_NEAR(found[i].believed / found[i].picked, 1.0, 1e-4) << i;
        }
    }
}

}  // namespace
}  // namespace lacuna::test
