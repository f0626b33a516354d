// How often next event through glass, next event along known ways, and specular chains are tried: that depends on what
// they bring to a view. (theory.md, "Effort behind glass")
#include <gtest/gtest.h>

#include "libcore/methods/glass_effort.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

enum class LampKind { Square, Point };

/// A room under a lamp, which is open or in a box of glass; with or without a mirror ball and a ball of glass.
SceneBuilder floorUnderALamp(bool behindGlass, bool balls, LampKind kind = LampKind::Square) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(box({-2, 0, -2}, {2, 3, 2}, 0, true));
    if (kind == LampKind::Square) {
        const std::uint32_t lamp = b.add(emitter(Rgb(20.0f), true));
        b.add(quad({-0.2f, 2.5f, 0.2f}, {0, 0, -0.4f}, {0.4f, 0, 0}, lamp));
    } else {
        b.add(pointLight({0, 2.5, 0}, Rgb(1.0f)));
    }
    if (behindGlass) b.add(box({-0.5f, 2.2f, -0.5f}, {0.5f, 2.7f, 0.5f}, b.add(glass(1.5f))));
    if (balls) {
        b.add(sphere({0.5f, 0.3f, 0.3f}, 0.1f, 16, b.add(mirror(Rgb(0.9f))), true));
        b.add(sphere({-0.5f, 0.3f, 0.3f}, 0.1f, 16, b.add(glass(1.5f)), true));
    }
    b.add(lookAt({0.2, 1.2, 1.9}, {0, 0.4, 0}, 50));
    return b;
}

GlassEffort effortIn(const Scene& scene, int threads = 2, RenderSettings settings = {},
                     const char* method = "bpt") {
    const ThreadPool pool(threads);
    settings.limits.maxDepth = 8;
    settings.chainSeeds = std::make_shared<const ChainSeeds>(scene, pool);
    settings.smoothGlass = std::make_shared<const SmoothGlass>(scene);
    const Camera camera = scene.makeCamera("", {64, 48}, {});
    return glassEffortFor(scene, camera, rowNamed(method).techniques, settings, pool);
}

TEST(GlassEffort, isLargeWhereAllLightComesThroughGlass) {
    EXPECT_GT(effortIn(*floorUnderALamp(true, false).build()).refractions, 0.5);
}

TEST(GlassEffort, isLittleWhereFewPlacesGetAnyOfIt) {
    const GlassEffort effort = effortIn(*floorUnderALamp(false, true).build());
    EXPECT_LT(effort.refractions, 0.5);
    EXPECT_LT(effort.knownWays, 0.5);
    EXPECT_GE(effort.refractions, 1.0 / 16);
    EXPECT_GE(effort.knownWays, 1.0 / 16);
}

TEST(GlassEffort, ofChainsIsLargeWhereAllLightComesByThem) {
    const auto scene = floorUnderALamp(true, false, LampKind::Point).build();
    const double effort = effortIn(*scene, 2, {}, "pt").chains;
    EXPECT_GT(effort, 1);
    EXPECT_LE(effort, 2);
}

TEST(GlassEffort, ofChainsIsLittleWhereFewPlacesGetAnyOfIt) {
    const auto scene = floorUnderALamp(false, true, LampKind::Point).build();
    const double effort = effortIn(*scene, 2, {}, "pt").chains;
    EXPECT_LT(effort, 0.5);
    EXPECT_GE(effort, 1.0 / 8);
}

/// Rows that splat make the caustics that the lens sees directly. Their chains are those of caustics seen in mirrors
/// alone, so what the search is worth is another figure.
TEST(GlassEffort, ofChainsIsAnotherForRowsThatSplat) {
    const auto scene = floorUnderALamp(false, true, LampKind::Point).build();
    const auto of = [&](const char* method) { return effortIn(*scene, 2, {}, method).chains; };
    EXPECT_NE(of("pt"), of("bpt"));
    EXPECT_EQ(of("lvcbpt"), of("bpt"));
}

TEST(GlassEffort, isOneWhereThereIsNothingToTry) {
    for (const LampKind lamp : {LampKind::Square, LampKind::Point}) {
        const GlassEffort effort = effortIn(*floorUnderALamp(false, false, lamp).build());
        EXPECT_EQ(effort.refractions, 1);
        EXPECT_EQ(effort.knownWays, 1);
        EXPECT_EQ(effort.chains, 1);
    }
}

TEST(GlassEffort, doesNotDependOnThreads) {
    SceneBuilder b = floorUnderALamp(false, true);
    b.add(pointLight({0, 2, 0}, Rgb(1.0f)));
    const auto scene = b.build();
    const GlassEffort one = effortIn(*scene, 1), three = effortIn(*scene, 3);
    EXPECT_EQ(one.refractions, three.refractions);
    EXPECT_EQ(one.knownWays, three.knownWays);
    EXPECT_EQ(one.chains, three.chains);
}

/// The effort depends on the view alone, so that a crop is a part of the picture, and another seed makes the same
/// render.
TEST(GlassEffort, isOfTheView) {
    SceneBuilder b = floorUnderALamp(false, true);
    b.environment(LACUNA_SCENES "/sky.hdr");
    b.add(pointLight({0, 2, 0}, Rgb(1.0f)));
    b.d.meshes[0] = quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4});  // out of doors
    const auto scene = b.build();
    RenderSettings other;
    other.seed = 7;
    other.crop = {3, 9, 2, 5};
    other.sampling = Sampling::Sobol;
    other.lightPaths = 100;
    other.transparentBackground = true;
    other.glassEffort = {0.1, 0.2, 1.5};
    const GlassEffort effort = effortIn(*scene), again = effortIn(*scene, 2, other);
    EXPECT_EQ(effort.refractions, again.refractions);
    EXPECT_EQ(effort.knownWays, again.knownWays);
    EXPECT_EQ(effort.chains, again.chains);
    EXPECT_LT(effort.refractions, 1);
    EXPECT_NE(effort.chains, 1);
}

}  // namespace
}  // namespace lacuna::test
