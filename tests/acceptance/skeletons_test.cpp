// Acceptance 9: a skeleton of nonsense (nodes anywhere, in walls and outside of the room, balls of
// any size, a random map) makes a noisier picture with the same mean.
#include <gtest/gtest.h>

#include "libcore/skeleton/node_map.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

std::shared_ptr<const Skeleton> randomSkeleton(std::uint64_t seed) {
    Rng rng(seed, 0, StreamKind::User, 0);
    const auto anywhere = [&] { return 6.0 * rng.uniformDouble() - 3.0; };
    auto skeleton = std::make_shared<Skeleton>();
    for (int i = 0; i < 12; ++i) {
        // Radii from 1e-9 of the room to ten times its size.
        const double radius = 20.0 * std::pow(1e-9, rng.uniformDouble());
        skeleton->nodes.push_back({{anywhere(), anywhere(), anywhere()}, radius});
    }
    const VoxelShape shape{{9, 9, 9}, {-4, -4, -4}, 0.5};
    std::vector<std::uint16_t> entries(shape.count());
    for (std::uint16_t& e : entries) {
        e = rng.below(5) == 0 ? NodeMap::kNone : std::uint16_t(rng.below(12));
        if (rng.below(3) == 0) e |= NodeMap::kSolid;
    }
    skeleton->map = NodeMap(shape, std::move(entries));
    return skeleton;
}

TEST(SkeletonsOfNonsense, leaveTheMeanAsItIs) {
    const auto scene = diffuseBox().builder.build();
    Shot shot;
    shot.width = shot.height = 12;
    shot.maxDepth = 4;
    shot.iterations = 600;
    shot.seed = 100;
    const Picture reference = render(*scene, pathTracer(), shot);
    shot.seed = 1;
    shot.iterations = 300;
    const MethodRow row = rowNamed("skelbpt");
    for (const char* weights : {"weights=aware", "weights=credit"}) {
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            const std::vector<std::string> settings = {"candidates=144", "node_acceptance=0",
                                                       weights};
            const auto method = row.create(resolve(row, settings));
            method->useSkeleton(randomSkeleton(seed));
            const Picture picture = Render(*scene, row, shot, *method).run();
            expectSame(picture, reference, weights);
        }
    }
}

}  // namespace
}  // namespace lacuna::test
