// Scenes of bugs that users of bidirectional renderers have reported: spikes, lamps that shine on
// the wrong side, slabs of glass, faces that lie twice in one place.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

class Reports : public RowTest {
  protected:
    static const Picture& reference(const SceneBuilder& builder, Shot shot) {
        shot.seed += 100;
        return RowTest::reference(builder, shot);
    }
};
INSTANTIATE_TEST_SUITE_P(All, Reports, testing::ValuesIn(rowNames(Rows::OfTheTool)), ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, Reports, testing::ValuesIn(rowNames(Rows::OfTests)), ByParameter());

/// Connections of vertices that nearly touch have no bound on their brightness, unless the weights
/// allow for it. Inside a coarse sphere with smooth normals there are such pairs everywhere.
TEST_P(Reports, noSpikesInsideABentSphere) {
    SceneBuilder b;
    b.add(sphere({0, 0, 0}, 1, 8, b.add(matte(Rgb(0.7f))), true));
    b.add(pointLight({0.2, 0.3, -0.1}, Rgb(1.0f)));
    b.add(lookAt({0, 0, 0.7}, {0.1, 0, -0.2}, 60));
    Shot shot = quickShot(80);
    shot.maxDepth = 4;
    const Picture p = render(*b.build(), row(), shot);
    expectSame(p, reference(b, shot), row().name + ", inside a bent sphere", Judge::BlocksAndMean);
    double largest = 0;
    for (const Rgb& c : p.pixels.image().pixels) {
        largest = std::max(largest, double(mean(c)) / p.mean());
    }
    // Distances and cosines to the light alone make a factor of 4 between places here; the noise of
    // 80 iterations adds half as much again. Spikes in the report were a thousand times the mean.
    EXPECT_LT(largest, 10) << row().name;
    stabilityCase("connection-spikes", largest, "times the mean in the brightest pixel");
}

/// Two lamps of one mesh that face up; with `mirrored` = -1 a mirroring transform turns one of them
/// over.
SceneBuilder lamps(double mirrored) {
    SceneBuilder b;
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    const auto lamp =
        b.add(quad({-0.4f, 0, 0.3f}, {0.8f, 0, 0}, {0, 0, -0.6f}, b.add(emitter(Rgb(4.0f)))),
              translation({0.9, 1.5, 0}) * scaling({-1, 1, 1}));
    b.instance(lamp, translation({-0.3, 1.8, 0.2}) * scaling({1, mirrored, 1}));
    b.add(lookAt({0, 1, 3}, {0, 0, 0}, 34));
    return b;
}

TEST_P(Reports, mirroredLampsShineOnOneSide) {
    Shot shot = quickShot(80);
    shot.maxDepth = 2;
    expectRadiance(render(*lamps(1).build(), row(), shot), 0, row().name + ", lamps that face up");
    // Turned over by hand: the same picture without any transform.
    SceneBuilder baked;
    baked.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    baked.add(
        quad({-0.7f, 1.8f, -0.1f}, {0.8f, 0, 0}, {0, 0, 0.6f}, baked.add(emitter(Rgb(4.0f)))));
    baked.add(lookAt({0, 1, 3}, {0, 0, 0}, 34));
    expectSame(render(*lamps(-1).build(), row(), shot), reference(baked, shot),
               row().name + ", lamp turned over by a mirror");
    stabilityCase("emission-side", worstDeviation(), kOfAllowed);
}

/// A luminous wall, seen head on through a slab of glass, is dimmed by the slab's transmittance,
/// wherever the slab and the wall are.
TEST_P(Reports, slabsDimByTheirTransmittanceAtAnyDistance) {
    if (!seesThroughDeltas(row())) GTEST_SKIP() << "splats do not see through smooth glass";
    for (const auto& [slab, wall] : {std::pair(0.1, 1.0), std::pair(0.5, 1.0), std::pair(0.9, 1.0),
                                     std::pair(0.1, 1e3), std::pair(999.0, 1e3)}) {
        SceneBuilder b;
        const float w = 100;
        b.add(box({-w, -w, float(-slab - 0.05)}, {w, w, float(-slab)}, b.add(glass())));
        b.add(
            quad({-w, -w, float(-wall)}, {2 * w, 0, 0}, {0, 2 * w, 0}, b.add(emitter(Rgb(2.0f)))));
        b.add(lookAt({0, 0, 0}, {0, 0, -1}, 1));
        Shot shot = quickShot(60);
        shot.width = shot.height = 8;
        shot.maxDepth = 12;
        // Each face reflects R = 0.04. With all reflections between the faces, (1 - R) / (1 + R)
        // gets through.
        expectRadiance(render(*b.build(), row(), shot), 2 * 0.96 / 1.04,
                       row().name + ", slab at " + std::to_string(slab));
    }
    stabilityCase("glass-slab", worstDeviation(), kOfAllowed);
}

/// A slab shifts what passes it by the same amount wherever it is, so that the floor gets the same
/// light from the lamp.
TEST_P(Reports, slabsUnderALampMayBeAnywhere) {
    const auto withSlab = [](float y) {
        SceneBuilder b;
        b.add(quad({-1.5f, 0, 1.5f}, {3, 0, 0}, {0, 0, -3}));
        b.add(box({-4, y, -4}, {4, y + 0.1f, 4}, b.add(glass())));
        b.add(quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add(emitter(Rgb(3.0f)))));
        b.add(lookAt({0, 0.7, 2}, {0, 0, 0.1}, 30));
        return b;
    };
    Shot shot = quickShot(80);
    shot.maxDepth = 6;
    expectSame(render(*withSlab(1.8f).build(), row(), shot), reference(withSlab(0.9f), shot),
               row().name + ", slab near the lamp", Judge::BlocksAndMean);
    stabilityCase("glass-slab", worstDeviation(), kOfAllowed);
}

/// Every face but the lamp's lies in the scene twice.
TEST_P(Reports, facesThatLieTwiceInOnePlaceChangeNothing) {
    SceneBuilder once = stage();
    SceneBuilder twice = once;
    const std::size_t meshes = once.d.meshes.size();
    for (std::size_t i = 0; i < meshes; ++i) twice.add(Mesh(once.d.meshes[i]));
    addLight(once, LightChoice::Quad);
    addLight(twice, LightChoice::Quad);
    const Shot shot = quickShot(80);
    expectSame(render(*twice.build(), row(), shot), reference(once, shot),
               row().name + ", faces twice");
    stabilityCase("duplicate-faces", worstDeviation(), kOfAllowed);
}

/// A sample that overflows is dropped, counted, and reported with its place. So is a finite sample
/// whose pixel's sum overflows. The picture stays finite.
TEST_P(Reports, samplesThatOverflowAreDroppedAndCounted) {
    SceneBuilder b;
    b.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
    // The sum of its channels' powers just fits into a float. The light is so near that each of the
    // samples of a method with several overflows as well.
    b.add(pointLight({0, 0.01, 0}, Rgb(8e36f)));
    b.add(lookAt({0, 1, 1.5}, {0, 0, 0}, 5));
    Shot shot = quickShot(20);
    shot.maxDepth = 2;
    const Picture p = render(*b.build(), row(), shot);
    std::size_t bad = 0;
    for (const Rgb& c : p.pixels.image().pixels) bad += !isFinite(c);
    EXPECT_EQ(bad, 0u);
    EXPECT_GT(p.statistics.invalidSamples, 0u);
    EXPECT_FALSE(p.statistics.invalidReplays.empty());
    stabilityCase("overflow", double(bad), "pixels not finite");
}

}  // namespace
}  // namespace lacuna::test
