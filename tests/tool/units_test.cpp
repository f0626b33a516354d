// Parts that all tools share, each tested alone.
#include <gtest/gtest.h>

#include "libcore/tool/effects.h"
#include "libcore/tool/progress.h"
#include "libcore/tool/tool.h"

namespace lacuna {
namespace {

TEST(ToolUnits, Durations) {
    EXPECT_EQ(durationText(0.4), "0s");
    EXPECT_EQ(durationText(65.0), "1m05s");
    EXPECT_EQ(durationText(7380.0), "2h03m");
    EXPECT_EQ(durationText(-3.0), "0s");
}

TEST(ToolUnits, CommandLinesAreQuoted) {
    const char* const arguments[] = {"tool", "a b", "it's", "--set", "x=1", ""};
    EXPECT_EQ(commandLineText(6, arguments), "tool 'a b' 'it'\\''s' --set x=1 ''");
}

TEST(ToolUnits, EffectsFollowWhatInstancesUse) {
    SceneDescription scene;
    scene.materials.resize(3);
    scene.materials[1].transmission = 1.0f;
    scene.materials[1].metallic = 0.0f;
    scene.materials[1].thin = false;
    scene.materials[1].roughness = 0.0f;
    scene.materials[2].emission = Rgb(1.0f);
    scene.materials[2].alphaMode = Material::Alpha::Blend;
    scene.meshes.resize(3);
    for (std::uint32_t m = 0; m < 3; ++m) {
        scene.meshes[m].material = m;
        scene.meshes[m].triangles = {{0, 1, 2}};
    }
    const auto simulated = [&](const std::string& name) {
        for (const Effect& e : effectsOf(scene, 0.0, nullptr)) {
            if (e.name == name) return e.simulated;
        }
        ADD_FAILURE() << name;
        return false;
    };
    // Without instances, the scene calls for no effect.
    for (const Effect& e : effectsOf(scene, 0.0, nullptr)) EXPECT_FALSE(e.simulated) << e.name;
    scene.instances = {{1, {}}};
    EXPECT_TRUE(simulated("smooth_refraction"));
    EXPECT_TRUE(!simulated("rough_refraction") && !simulated("area_lights"));
    EXPECT_TRUE(!simulated("diffuse"));
    // With index 1, light goes straight on, so glass of any roughness is rendered as smooth.
    scene.materials[1].roughness = 0.5f;
    EXPECT_TRUE(!simulated("smooth_refraction") && simulated("rough_refraction"));
    scene.materials[1].ior = 1.0f;
    EXPECT_TRUE(simulated("smooth_refraction") && !simulated("rough_refraction"));
    scene.instances = {{0, {}}, {2, {}}, {2, {}}};
    EXPECT_TRUE(!simulated("smooth_refraction") && simulated("area_lights"));
    EXPECT_TRUE(simulated("glossy") && !simulated("mirror"));
    EXPECT_TRUE(simulated("alpha_blend") && !simulated("alpha_mask"));
    for (const Effect& e : effectsOf(scene, 0.0, nullptr)) {
        if (e.name == "area_lights") {
            EXPECT_EQ(e.reason, "2 emissive triangles");
        }
    }
}

}  // namespace
}  // namespace lacuna
