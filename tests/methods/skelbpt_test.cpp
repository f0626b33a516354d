// What skelbpt's weights believe of its picks: that a node sees what its map of distances says, and
// that the pmfs are combined by the maximum heuristic.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "libcore/base/parallel.h"
#include "libcore/methods/registry.h"
#include "libcore/skeleton/node_map.h"
#include "tests/fixtures/beliefs.h"
#include "tests/fixtures/finite_space.h"
#include "tests/fixtures/test_rows.h"

namespace lacuna::test {
namespace {

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

/// What is picked M times as often, of a belief of n r samples: R of 1 / (1/M + (1 - 1/M) / R).
double oftenness(double samples, int subpaths) {
    const double perSubpath = 1.0 / double(subpaths);
    return (1.0 - perSubpath) / (1.0 / samples - perSubpath);
}

// Where every iteration has the same pool, the frozen means are this pool's, and the belief is
// exact but for the choice among the pmfs: it takes each by the share m of the sum of maxima that
// it owns (that sum is Z), and the selector takes each of k that own anything alike. So what a
// vertex is believed to be picked is m k / Z = m k / sum m of what it is: alike for all that one
// pmf owns, and k on average over the k pmfs.
TEST(SkeletonBeliefs, areThePicksButForTheEvenChoice) {
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
    const MethodRow& row = findMethod("skelbpt");
    const std::vector<std::string> settings = {"candidates=6", "node_acceptance=0"};
    const auto method = row.create(resolve(row, settings));
    give(*method, oneNode());
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
    std::map<std::uint32_t, double> ratio;  // by the pmf that owns the vertex
    for (std::size_t i = 0; i < kSubpaths; ++i) {
        ASSERT_GT(found[i].picked, 0.0) << i;
        const double r =
            oftenness(found[i].believed, kSubpaths) / oftenness(found[i].picked, kSubpaths);
        const auto [owned, first] = ratio.try_emplace(found[i].label, r);
        EXPECT_NEAR(r / owned->second, 1.0, 1e-6) << i << " of pmf " << found[i].label;
    }
    EXPECT_GE(ratio.size(), 2u);
    double sum = 0.0;
    for (const auto& [owner, r] : ratio) sum += r;
    EXPECT_NEAR(sum / double(ratio.size()), 1.0, 1e-6);
}

}  // namespace
}  // namespace lacuna::test
