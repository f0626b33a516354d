// What skelbpt's weights believe at a wall with nodes on both sides: what its selector does on the
// side that the path is on.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libcore/base/parallel.h"
#include "libcore/methods/registry.h"
#include "libcore/skeleton/node_map.h"
#include "tests/fixtures/beliefs.h"
#include "tests/fixtures/fixed_eye_path.h"
#include "tests/fixtures/test_rows.h"

namespace lacuna::test {
namespace {

/// An eye path that comes to a wall at z = 0 from above, and then to the same wall from below.
/// Nothing is in anything's way.
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

/// Five layers of voxels along z, the middle one the wall; a node above, a node below.
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

// One pmf per node, so that no even choice among pmfs comes between belief and picks. The two nodes
// want other light vertices: what one is next to is far from the other.
TEST(SkeletonSides, beliefsAreThoseOfThePathsSide) {
    constexpr int kSubpaths = 6;
    const LightPool pool = poolOfPairs(kSubpaths, [](int i, PathVertex& y) {
        y.position = {0.3f, 0.4f * float(i), i % 2 == 0 ? 1.5f : -1.5f};
        y.throughput = Rgb(1.0f);
    });
    const WallFromBothSides space;
    const ThreadPool threads(1);
    const MethodRow& row = findMethod("skelbpt");
    const std::vector<std::string> settings = {"candidates=6", "distributions=c",
                                               "node_acceptance=0"};
    IterationStatistics statistics;
    IterationContext context{space, threads, 41, 1000, statistics};
    const auto method = row.create(resolve(row, settings));
    give(*method, nodeOnEitherSide());
    const ConnectionDensity& density = settle(*method, pool, context, 2);

    // Without labels, when the node is looked up on the way, and with those of a walk.
    std::vector<PathVertex> eye(space.eye().begin(), space.eye().end());
    for (const bool labelled : {false, true}) {
        if (labelled) density.labelWalk(eye);
        std::vector<Belief> found[2];
        for (const std::size_t t : {2, 3}) {
            found[t - 2] = beliefs(
                *method, density, Subpath(eye).first(t), kSubpaths, 1.0,
                [](const PathVertex& y) { return std::size_t(std::lround(y.position.y / 0.4f)); });
            for (std::size_t i = 0; i < kSubpaths; ++i) {
                const Belief& b = found[t - 2][i];
                ASSERT_GT(b.picked, 0.0) << i;
                EXPECT_NEAR(b.believed / b.picked, 1.0, 1e-6) << "t " << t << " vertex " << i;
            }
        }
        // The nodes disagree: believing the other one's could not pass.
        EXPECT_GT(found[0][0].picked, 1.5 * found[0][1].picked);
        EXPECT_GT(found[1][1].picked, 1.5 * found[1][0].picked);
    }
}

}  // namespace
}  // namespace lacuna::test
