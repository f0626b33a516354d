// What skelbpt's weights assume about its picks: a node sees what its map of distances says, and
// the pmfs are combined by the maximum heuristic.
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
#include "tests/fixtures/fixed_eye_path.h"
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

/// A skeleton with one node for all positions.
std::shared_ptr<const Skeleton> oneNode() {
    const VoxelShape shape{{1, 1, 1}, {-8, -8, -8}, 16};
    auto skeleton = std::make_shared<Skeleton>();
    skeleton->nodes = {{{0, 0, 0}, 1}};
    skeleton->map = NodeMap(shape, {0});
    return skeleton;
}

/// R of a connection that counts as n r = 1 / (1/M + (1 - 1/M) / R) samples: M times the
/// probability of the pick.
double oftenness(double samples, int subpaths) {
    const double perSubpath = 1.0 / double(subpaths);
    return (1.0 - perSubpath) / (1.0 / samples - perSubpath);
}

// Every iteration has the same pool, so the frozen means are those of this pool. Then the belief is
// exact except for the choice among the pmfs. The belief takes a pmf by its share m of the sum of
// maxima Z. The selector takes each of the k pmfs that own a vertex equally often. So the ratio of
// belief to picks is m k / Z: the same for all vertices of one pmf, and 1 on average over the k
// pmfs.
void expectThePicks(const std::vector<Belief>& found, std::size_t leastOwners) {
    std::map<std::uint32_t, double> ratio;  // by the pmf that owns the vertex
    for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_GT(found[i].picked, 0.0) << i;
        const int subpaths = int(found.size());
        const double r =
            oftenness(found[i].believed, subpaths) / oftenness(found[i].picked, subpaths);
        const auto [owned, first] = ratio.try_emplace(found[i].label, r);
        EXPECT_NEAR(r / owned->second, 1.0, 1e-6) << i << " of pmf " << found[i].label;
    }
    EXPECT_GE(ratio.size(), leastOwners);
    double sum = 0.0;
    for (const auto& [owner, r] : ratio) sum += r;
    EXPECT_NEAR(sum / double(ratio.size()), 1.0, 1e-6);
}

/// An eye path that meets a wall at z = 0 first from above and then from below. Nothing blocks any
/// ray.
class WallFromBothSides final : public FixedEyePath {
  public:
    WallFromBothSides() {
        Bsdf::Parameters p;
        p.baseColor = Rgb(0.5f);
        addLens({0, 0, 2});
        addSurface({0, 0, -0.2f}, p);
        addSurface({1, 0, 0.2f}, p);
    }
    float reach(const Vec3&, const Vec3&, RayTally&) const override {
        return std::numeric_limits<float>::infinity();
    }
};

/// Five layers of voxels along z, the middle one the wall, with one node above it and one below.
std::shared_ptr<const Skeleton> nodeOnEitherSide() {
    auto skeleton = std::make_shared<Skeleton>();
    skeleton->nodes = {{{0, 0, 1.5}, 1}, {{0, 0, -1.5}, 1}};
    const VoxelShape shape{{3, 3, 5}, {-1.5, -1.5, -2.5}, 1};
    std::vector<std::uint16_t> entries;
    for (const std::uint16_t layer : {1, 1, NodeMap::kSolid | 1, 0, 0}) {
        entries.insert(entries.end(), 9, layer);
    }
    skeleton->map = NodeMap(shape, std::move(entries));
    return skeleton;
}

TEST(SkeletonBeliefs, areThePicksButForTheEvenChoice) {
    constexpr int kSubpaths = 6;
    const LightPool pool = poolOfPairs(kSubpaths, [](int i, PathVertex& y) {
        y.position = {i % 2 == 0 ? 0.9f : 2.0f + 0.3f * float(i), 0.4f * float(i), 0.1f};
        // Hidden vertices are bright. If the weights took them for visible, they would expect to
        // pick them often.
        y.throughput = Rgb((i % 2 == 0 ? 1.0f : 20.0f) * float(1 + i * i));
    });
    const BehindAWall space;
    const ThreadPool threads(1);
    IterationStatistics statistics;
    IterationContext context{space, threads, 41, 0, 1000, statistics};
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
    expectThePicks(found, 2);
}

// The nodes prefer different light vertices: those next to one are far from the other.
TEST(SkeletonBeliefs, areThoseOfThePathsSide) {
    constexpr int kSubpaths = 6;
    const LightPool pool = poolOfPairs(kSubpaths, [](int i, PathVertex& y) {
        y.position = {0.3f, 0.4f * float(i), i % 2 == 0 ? 1.5f : -1.5f};
        y.throughput = Rgb(1.0f);
    });
    const WallFromBothSides space;
    const ThreadPool threads(1);
    const MethodRow& row = findMethod("skelbpt");
    const std::vector<std::string> settings = {"candidates=6", "node_acceptance=0"};
    IterationStatistics statistics;
    IterationContext context{space, threads, 41, 0, 1000, statistics};
    const auto method = row.create(resolve(row, settings));
    give(*method, nodeOnEitherSide());
    const ConnectionDensity& density = settle(*method, pool, context, 2);

    // First without labels, so that the node is looked up on the way, then with the labels of a
    // walk.
    std::vector<PathVertex> eye(space.eye().begin(), space.eye().end());
    for (const bool labelled : {false, true}) {
        if (labelled) density.labelWalk(eye);
        std::vector<Belief> found[2];
        for (const std::size_t t : {2, 3}) {
            found[t - 2] = beliefs(
                *method, density, Subpath(eye).first(t), kSubpaths, 1.0,
                [](const PathVertex& y) { return std::size_t(std::lround(y.position.y / 0.4f)); });
            SCOPED_TRACE(t);
            expectThePicks(found[t - 2], 1);
        }
        // The nodes disagree, so the other node's belief would fail.
        EXPECT_GT(found[0][0].picked, 1.5 * found[0][1].picked);
        EXPECT_GT(found[1][1].picked, 1.5 * found[1][0].picked);
    }
}

}  // namespace
}  // namespace lacuna::test
