// Two-stage resampling: the weights know what the second stage does.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/parallel.h"
#include "libcore/methods/registry.h"
#include "tests/fixtures/beliefs.h"
#include "tests/fixtures/fixed_eye_path.h"

namespace lacuna::test {
namespace {

/// One eye path from above to a surface at the origin. Light vertices arrive with a share of their
/// throughput and the same G. The surface sees all of them, or all except those next to the origin,
/// or none.
class OneSurface final : public FixedEyePath {
  public:
    static constexpr double kGeometry = 1e-3;  // less than any light vertex really has
    enum class Sees { All, NotTheNearest, Nothing };

    explicit OneSurface(Sees sees, float scattered = 1.0f) : sees_(sees), scattered_(scattered) {
        Bsdf::Parameters p;
        p.baseColor = Rgb(0.5f);
        addLens({0, 1, 2});
        addSurface({0, 0, 0}, p);
    }
    Arrival arrival(Subpath light, Subpath, bool) const override {
        return {light.back().throughput * scattered_, {}, kGeometry};
    }
    bool visible(const PathVertex& light, const PathVertex&, RayTally&) const override {
        return sees_ == Sees::All ||
               (sees_ == Sees::NotTheNearest && length(light.position) > 0.01f);
    }

  private:
    Sees sees_;
    float scattered_;
};

// Every iteration has the same pool and every cluster is one vertex, so Q2 is that of this pool.
// Then the belief is exact for what the second stage gives a vertex beyond its reserve: n r = 1 /
// (1/M1 + (1 - 1/M1) w), w the weight of the pick. The reserve goes to the vertex next to the
// surface. Without the share 1 - d, the belief would be 1 / (1 - d) times too high.
TEST(TwoStageWeights, believeWhatTheSecondStagePicks) {
    constexpr int kSubpaths = 6;
    const LightPool pool = poolOfPairs(kSubpaths, [](int i, PathVertex& y) {
        y.position = i == 0 ? Vec3{0, 0, 1e-4f} : Vec3{0.4f * float(i), 0, 1.5f};
        y.throughput = Rgb(float(1 + i * i));
    });
    const OneSurface space(OneSurface::Sees::NotTheNearest);
    const ThreadPool threads(1);
    const MethodRow& row = findMethod("tsrbpt");
    for (const char* defensive : {"defensive=0.25", "defensive=0.7"}) {
        SCOPED_TRACE(defensive);
        IterationStatistics statistics;
        IterationContext context{space, threads, 41, 0, 1, statistics};
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

/// The samples that the weights count for a connection of throughput 2 and scatter 3/4. The pool
/// has four subpaths of throughputs 1 to 4 that arrive with scatter 1/4.
double believed(OneSurface::Sees sees, const char* clusters) {
    const LightPool pool = poolOfPairs(4, [](int i, PathVertex& y) {
        y.position = {0.4f * float(i), 0, 1.5f};
        y.throughput = Rgb(float(1 + i));
    });
    const OneSurface space(sees, 0.25f);
    const ThreadPool threads(1);
    const MethodRow& row = findMethod("tsrbpt");
    IterationStatistics statistics;
    IterationContext context{space, threads, 41, 0, 1, statistics};
    const std::vector<std::string> settings = {"candidates=4", "cache_density=1", "defensive=0.5",
                                               "first_connections=2", clusters};
    const auto method = row.create(resolve(row, settings));
    const ConnectionDensity& density = settle(*method, pool, context, 3);
    const Subpath eye = space.eye();
    const Subpath light = pool.prefix(pool.connectable()[1]);
    Connection c{};
    c.eye = {&eye[1], &eye[0], 2, {}};
    c.order = 1;
    c.light = {&light[1], &light[0], 2, Rgb(0.75f)};
    c.beta = Rgb(2.0f);
    c.geometry = OneSurface::kGeometry;
    return density.effectiveSamples(c);
}

// Q1 is G times 10/4, whatever the clusters are, and Q2 is a quarter of that, so p/q1 = 2.5 / 2 and
// p/q2 = 0.625 / 1.5. The reserve takes half of the two picks: N (1 - d) = 1, so p/q2 stays as it
// is. p/q1 has the share 1/M2.
TEST(TwoStageWeights, knowHowManyClustersThereAre) {
    const double ratio1 = 1.25, ratio2 = 0.625 / 1.5;
    EXPECT_NEAR(believed(OneSurface::Sees::All, "second_candidates=2"),
                1.0 / (0.25 + 0.75 * (0.5 * ratio1 + 0.5 * ratio2)), 1e-5);
    EXPECT_NEAR(believed(OneSurface::Sees::All, "second_candidates=4"),
                1.0 / (0.25 + 0.75 * (0.25 * ratio1 + 0.75 * ratio2)), 1e-5);
}

// Where the point sees nothing, only the first stage helps.
TEST(TwoStageWeights, countOnTheFirstStageWhereNothingIsSeen) {
    EXPECT_NEAR(believed(OneSurface::Sees::Nothing, "second_candidates=2"),
                1.0 / (0.25 + 0.75 * 1.25), 1e-5);
}

}  // namespace
}  // namespace lacuna::test
