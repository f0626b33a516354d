// Which meshes are panes, and what share of rays passes them.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/rng.h"
#include "libcore/material/fresnel.h"
#include "tests/scene/surface_points.h"

namespace lacuna::test {
namespace {

/// The share of rays that pass through the middle of a square around the origin. They meet it `degrees` from its
/// normal, in the square's own space.
double passing(const Scene& scene, double degrees, const Affine& to, int rays = 20000) {
    RayTally tally;
    Rng rng(2, 0, StreamKind::User, 0);
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3d d = to.vector({std::sin(angle), 0, std::cos(angle)});
    int passed = 0;
    for (int i = 0; i < rays; ++i) {
        const Vec3d at = to.point({rng.uniform() - 0.5, rng.uniform() - 0.5, 0}) - scene.centre();
        const Vec3 from(at - d * 0.3), beyond(at + d * 0.3);
        passed += scene.visible(from, {}, beyond, {}, RayKind::Connection, tally);
    }
    return double(passed) / rays;
}

SceneBuilder sheetOf(const lacuna::Material& material, const Affine& to, Placement placement,
                     float bend = 0) {
    SceneBuilder b;
    Mesh mesh = quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, b.add(material));
    mesh.normals.assign(4, normalize(Vec3{bend, 0, 1}));
    place(b, mesh, to, placement);
    return b;
}

TEST(Pane, LetsPassWhatAllChannelsDo) {
    const Affine to = rotation({1, 2, 3}, 40) * scaling({2, -1, 0.25});
    for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
        const auto scene = sheetOf(pane({0.9f, 0.5f, 1.0f}, 1.7f), to, placement).build();
        for (const double degrees : {0.0, 40.0, 80.0, 88.0}) {
            const double angle = degrees * std::numbers::pi / 180;
            const Vec3d n = normalize(to.normal({0, 0, 1}));
            const Vec3d d = normalize(to.vector({std::sin(angle), 0, std::cos(angle)}));
            const double expected = 0.5 * (1 - fresnelDielectric(std::abs(dot(n, d)), 1.7));
            // False alarm 1e-6 each.
            EXPECT_NEAR(passing(*scene, degrees, to), expected,
                        5 * std::sqrt(expected * (1 - expected) / 20000) + 1e-4)
                << degrees;
        }
    }
}

TEST(Pane, IsThinFlatAndSmoothGlassAlone) {
    const auto passes = [](const lacuna::Material& m, float bend = 0) {
        return passing(*sheetOf(m, {}, Placement::Baked, bend).build(), 10, {}, 400) > 0.5;
    };
    EXPECT_TRUE(passes(pane()));
    EXPECT_TRUE(passes(pane(), 5e-4f));
    EXPECT_FALSE(passes(pane(), 0.01f));
    const auto with = [](auto change) {
        lacuna::Material m = pane();
        change(m);
        return m;
    };
    EXPECT_FALSE(passes(with([](auto& m) { m.thin = false; })));
    EXPECT_FALSE(passes(with([](auto& m) { m.roughness = 0.2f; })));
    EXPECT_FALSE(passes(with([](auto& m) { m.metallic = 0.1f; })));
    EXPECT_FALSE(passes(with([](auto& m) { m.transmission = 0.9f; })));
    EXPECT_FALSE(passes(with([](auto& m) { m.clearcoat = 0.5f; })));
    EXPECT_FALSE(passes(with([](auto& m) { m.emission = Rgb(1.0f); })));
    EXPECT_FALSE(passes(with([](auto& m) { m.baseColor = {1, 1, 0}; })));
    EXPECT_FALSE(passes(with([](auto& m) {
        m.without = {};
        m.without.add(LobeKind::SmoothThinTransmission);
    })));
}

/// The same glass on a window and on a curved mesh.
TEST(Pane, IsOfItsMeshAndNotOfItsMaterial) {
    SceneBuilder b;
    const auto glassy = b.add(pane());
    b.add(quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, glassy));
    Mesh curved = quad({-2, -2, 4}, {4, 0, 0}, {0, 4, 0}, glassy);
    curved.normals = {{0.3f, 0, 1}, {0, 0, 1}, {0, 0, 1}, {-0.3f, 0, 1}};
    b.add(curved);
    const auto scene = b.build();
    EXPECT_GT(passing(*scene, 0, {}, 400), 0.9);
    EXPECT_EQ(passing(*scene, 0, translation({0, 0, 4}), 400), 0.0);
    // Only the curved mesh blocks light for the skeleton.
    EXPECT_EQ(scene->blockingTriangles(pool()).size(), scene->triangleCount() - 2);
}

}  // namespace
}  // namespace lacuna::test
