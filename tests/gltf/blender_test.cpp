// scenes/blender-still-life.glb, as Blender 3.4 exported it: what scenes/make_blender_scene.py put
// there arrives, with nothing to warn about.
#include <algorithm>
#include <numbers>

#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {
namespace {

const Material& named(const SceneDescription& scene, const std::string& name) {
    for (const Material& m : scene.materials) {
        if (m.name == name) return m;
    }
    throw std::runtime_error("no material " + name);
}

TEST(Blender, TheStillLifeArrives) {
    const SceneDescription scene = loadGltf(LACUNA_SCENES "/blender-still-life.glb");
    expectValid(scene);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.width, 640);  // a custom property of the scene
    EXPECT_EQ(scene.maxDepth, 12);

    const Material& glass = named(scene, "glass");
    EXPECT_EQ(glass.transmission, 1.0f);
    EXPECT_EQ(glass.roughness, 0.0f);
    EXPECT_EQ(glass.ior, 1.5f);
    EXPECT_FALSE(glass.thin);
    EXPECT_EQ(named(scene, "tiles").specular, 0.0f);
    EXPECT_TRUE(named(scene, "tiles").baseColorTexture);
    EXPECT_TRUE(named(scene, "enamel").metallicRoughnessTexture);
    EXPECT_TRUE(named(scene, "copper").normalTexture);
    // Tangents are exported of all, read where a normal map uses them.
    EXPECT_EQ(std::count_if(scene.meshes.begin(), scene.meshes.end(),
                            [](const Mesh& m) { return !m.tangents.empty(); }),
              1);
    const Material& panel = named(scene, "panel");
    EXPECT_NEAR(panel.emission.r, 12.0f, 1e-5f);
    EXPECT_FALSE(panel.doubleSided);
}

TEST(Blender, LinkedDuplicatesShareTheirMesh) {
    const SceneDescription scene = loadGltf(LACUNA_SCENES "/blender-still-life.glb");
    std::vector<int> uses(scene.meshes.size());
    int mirrored = 0;
    for (const Instance& i : scene.instances) {
        ++uses[i.mesh];
        mirrored += i.toWorld.determinant() < 0.0;
    }
    std::sort(uses.begin(), uses.end());
    EXPECT_EQ(uses, (std::vector<int>{1, 1, 1, 1, 1, 1, 5}));
    EXPECT_EQ(mirrored, 1);
}

TEST(Blender, UnitlessLightsAreWattsPerSteradian) {
    const SceneDescription scene = loadGltf(LACUNA_SCENES "/blender-still-life.glb");
    ASSERT_EQ(scene.lights.size(), 3u);
    const PunctualLight &point = scene.lights[0], &spot = scene.lights[1], &sun = scene.lights[2];
    EXPECT_EQ(point.kind, PunctualLight::Kind::Point);
    EXPECT_NEAR(point.intensity.r, 12.0 / (4.0 * std::numbers::pi), 1e-5);
    EXPECT_EQ(spot.kind, PunctualLight::Kind::Spot);
    EXPECT_NEAR(spot.intensity.r, 40.0 / (4.0 * std::numbers::pi), 1e-5);
    EXPECT_NEAR(spot.outerConeAngle, 18.0 * std::numbers::pi / 180.0, 1e-5);
    EXPECT_EQ(sun.kind, PunctualLight::Kind::Directional);
    EXPECT_NEAR(sun.intensity.b, 0.5, 1e-6);
    EXPECT_LT(sun.direction.y, -0.5);  // Blender's +Z is up
}

}  // namespace
}  // namespace lacuna::test
