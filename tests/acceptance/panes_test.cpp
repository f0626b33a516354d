// Panes: rays pass thin flat smooth glass. So connections through a window join lamps with what they light, and that
// with the eye. (theory.md, "Panes")
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcore/bidir/features.h"
#include "libcore/material/fresnel.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

class Panes : public RowTest {};
INSTANTIATE_TEST_SUITE_P(All, Panes, testing::ValuesIn(rowNames(Rows::OfTheTool)), ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, Panes, testing::ValuesIn(rowNames(Rows::OfTests)), ByParameter());

double openOf(double cosine) {
    return 1 - fresnelDielectric(cosine, 1.5);
}

/// If paths had vertices at the glass, none of their edges could be joined, and no lamp could be hit.
TEST_P(Panes, pointLightBehindGlassIsSeenThroughGlass) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}));
    const auto clear = b.add(pane());
    // The lamp is above both, the camera between the two.
    for (const float y : {1.65f, 1.0f}) b.add(quad({-9, y, 9}, {18, 0, 0}, {0, 0, -18}, clear));
    const Vec3d lamp{0.2, 1.8, 0};
    b.add(pointLight(lamp, Rgb(2.0f)));
    b.add(lookAt({0.3, 1.5, 2}, {0, 0, 0.2}, 40));
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 2;
    shot.iterations = 200;
    shot.lightPaths = 1024;
    const Camera camera = scene->makeCamera("", {shot.width, shot.height}, {});
    const Vec3d from = Vec3d(camera.position()) + scene->centre();
    const std::vector<Rgb> exact = meanOverPixels(camera, shot, [&](Vec3d d) {
        const Vec3d toLamp = lamp - (from - d * (from.y / d.y));
        const double distance = length(toLamp), cosine = toLamp.y / distance;
        const double irradiance =
            2 * cosine / (distance * distance) * openOf(cosine) * openOf(cosine);
        const double radiance = irradiance * openOf(-d.y) * 0.6 / std::numbers::pi;
        return Vec3d{radiance, radiance, radiance};
    });
    expectRadiance(render(*scene, row(), shot), exact, row().name + ", point light and panes");
}

/// Sheets of coloured glass before the camera, under the lamp and beside it: instanced, turned and mirrored. `bend`:
/// how far their normals lean, in radians.
SceneBuilder behindColours(float bend) {
    SceneBuilder b;
    b.d.materials[0] = matte({0.4f, 0.3f, 0.3f});
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    b.add(quad({-2, 0, -1}, {4, 0, 0}, {0, 3, 0}, b.add(matte({0.2f, 0.4f, 0.2f}))));
    b.add(quad({-0.6f, 1.8f, -0.3f}, {1, 0, 0}, {0, 0, 0.6f}, b.add(emitter({2, 3, 4}, true))));
    b.add(lookAt({0.3, 1.2, 2}, {0, 0.3, 0}, 45));
    const auto sheet = [&](Vec3 corner, Vec3 e1, Vec3 e2, Rgb color, float ior) {
        Mesh m = quad(corner, e1, e2, b.add(pane(color, ior)));
        const Vec3 n = normalize(cross(e1, e2)), along = normalize(e1) * bend;
        m.normals.assign(m.positions.size(), normalize(n + along));
        return m;
    };
    b.add(sheet({-2, 0, 1}, {2.2f, 0, 0.1f}, {0, 2, 0}, {0.9f, 0.5f, 0.7f}, 1.5f));
    b.add(sheet({-2, 1.4f, 1}, {4, 0, 0}, {0, 0, -2}, {0.8f, 1.0f, 0.9f}, 1.3f));
    const auto small =
        b.add(sheet({-0.5f, -0.3f, 0}, {1, 0, 0}, {0, 0.6f, 0}, {1.0f, 0.6f, 0.2f}, 1.8f),
              translation({-0.6, 0.5, 0}) * rotation({1, 2, 3}, 40));
    b.instance(small,
               translation({0.7, 0.5, 0.3}) * rotation({0, 1, 0}, 70) * scaling({-1, 1.5, 0.5}));
    return b;
}

/// Sheets whose normals lean a little are no panes: paths meet their glass only at vertices. They look the same.
TEST_P(Panes, areTheSheetsThatAllMeet) {
    if (!seesThroughDeltas(row())) GTEST_SKIP() << "splats do not see through smooth glass";
    const auto bent = behindColours(0.004f).build();
    const auto flat = behindColours(0).build();
    Shot shot;
    shot.maxDepth = 12;
    shot.iterations = 2000;
    shot.seed = 100;
    static const Picture reference = render(*bent, rowNamed("bpt"), shot);
    shot.seed = 1;
    shot.iterations = 200;
    expectSame(render(*flat, row(), shot), reference, row().name + ", coloured panes",
               Judge::BlocksAndMean);
}

/// A ball of panes: what passes and what is reflected, also inside it, add up to all light.
TEST_P(Panes, takeNothingAway) {
    if (!seesThroughDeltas(row())) GTEST_SKIP() << "splats do not see through smooth glass";
    SceneBuilder b;
    b.add(sphere({0, 0, 0}, 1, 16, b.add(pane(Rgb(1.0f), 2.5f))));
    b.add(lookAt({0, 0.5, 4}, {0, 0, 0}, 16));
    b.environment(constantSky(1));
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 100;
    shot.iterations = 2000;
    shot.width = shot.height = 8;
    // A splat of the sky onto the lens is rare, and brings a whole pixel's worth.
    expectRadiance(render(*scene, row(), shot), 1, row().name + ", ball of panes", Judge::MeanOnly);
}

/// Two panes, one behind the other, before a wall: the feature layers show the wall, without specks.
TEST(PanesInLayers, areLookedThrough) {
    SceneBuilder b;
    b.add(quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}, b.add(matte({0.6f, 0.3f, 0.1f}))));
    const auto dense = b.add(pane({0.5f, 0.3f, 0.4f}, 3.0f));
    for (const float z : {0.0f, 0.5f}) b.add(quad({-9, -9, z}, {18, 0, 0}, {0, 18, 0}, dense));
    b.add(lookAt({0, 0, 1}, {0, 0, 0}, 90));
    const auto scene = b.build();
    const Camera camera = scene->makeCamera("", {16, 16}, {});
    const FeatureLayers layers = renderFeatures(*scene, camera, {0, 16, 0, 16}, 1, pool());
    for (std::size_t i = 0; i < layers.z.size(); ++i) {
        EXPECT_NEAR(layers.z[i], 2.0f, 1e-4f);
        EXPECT_NEAR(layers.albedo.pixels[i].r, 0.6f, 1e-4f);
        EXPECT_NEAR(layers.normal.pixels[i].b, 1.0f, 1e-4f);
    }
}

}  // namespace
}  // namespace lacuna::test
