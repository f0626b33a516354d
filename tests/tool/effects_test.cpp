// --effect NAME=on|off: an effect that is forced on changes no picture. One that is forced off is missing, and a
// warning says so.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/image/image_io.h"
#include "libcore/tool/effect_switches.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

TEST(EffectSwitches, LaterOnesWin) {
    const std::vector<std::string> texts = {"hits=off", "textures=off", "textures=on"};
    const auto switches = parseEffectSwitches(texts);
    ASSERT_EQ(switches.size(), 2u);
    EXPECT_EQ(switches[0].name, "hits");
    EXPECT_FALSE(switches[0].on);
    EXPECT_EQ(switches[1].name, "textures");
    EXPECT_TRUE(switches[1].on);
    for (const std::string wrong : {"hits", "hits=", "hits=maybe", "=on", ""}) {
        EXPECT_THROW(parseEffectSwitches(std::span(&wrong, 1)), UsageError) << wrong;
    }
}

/// A scene that uses every effect.
SceneDescription everything() {
    SceneDescription scene;
    Texture texel;
    texel.width = texel.height = 1;
    texel.rgba = {255, 255, 255, 255};
    scene.textures.push_back(texel);
    TextureUse use;
    use.value = 0;
    scene.materials.resize(6);
    Material& m = scene.materials[0];
    m.emission = Rgb(1.0f);
    m.emissiveTexture = m.baseColorTexture = m.normalTexture = use;
    m.alphaMode = Material::Alpha::Mask;
    scene.materials[1].alphaMode = Material::Alpha::Blend;
    scene.materials[1].absorption = Rgb(1.0f);
    scene.materials[1].specularColor = Rgb(0.5f);
    scene.materials[1].clearcoat = 0.5f;
    scene.materials[1].sheenColor = Rgb(0.5f);
    scene.materials[1].anisotropy = 0.5f;
    scene.materials[1].diffuseTransmission = 0.5f;
    for (std::uint32_t i = 2; i < 6; ++i) {  // smooth and rough glass, thin and solid
        scene.materials[i].metallic = 0.0f;
        scene.materials[i].transmission = 1.0f;
        scene.materials[i].roughness = i % 2 == 0 ? 0.0f : 0.5f;
        scene.materials[i].thin = i < 4;
    }
    scene.materials[0].roughness = 0.0f;
    scene.materials[1].metallic = 0.5f;
    scene.meshes.resize(6);
    for (std::uint32_t i = 0; i < 6; ++i) {
        scene.meshes[i].positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        scene.meshes[i].triangles = {{0, 1, 2}};
        scene.meshes[i].colors.assign(3, {1, 1, 1, 1});
        scene.meshes[i].material = i;
        scene.instances.push_back({i, {}});
    }
    for (const auto kind : {PunctualLight::Kind::Point, PunctualLight::Kind::Spot,
                            PunctualLight::Kind::Directional}) {
        PunctualLight light;
        light.kind = kind;
        light.intensity = Rgb(1.0f);
        scene.lights.push_back(light);
    }
    scene.environment = EnvironmentDescription{"sky.hdr", 1.0, 0.0};
    return scene;
}

TEST(EffectSwitches, OffIsGoneAndSaid) {
    const MethodRow& row = findMethod("bpt");
    std::vector<std::string> names;
    for (const Effect& e : effectsOf(everything(), 0.1, &row)) {
        ASSERT_TRUE(e.simulated) << e.name;
        names.push_back(e.name);
    }
    for (const std::string& name : names) {
        SceneDescription scene = everything();
        double lens = 0.1;
        Techniques techniques = row.techniques;
        auto effects = effectsOf(scene, lens, &row);
        const std::vector<EffectSwitch> off = {{name, false}};
        const auto warnings = forceEffects(off, {scene, lens, &techniques}, effects);
        ASSERT_EQ(warnings.size(), 1u) << name;
        EXPECT_NE(warnings[0].find(name), std::string::npos);
        // The rest of the scene does not call for the effect any more.
        MethodRow rest = row;
        rest.techniques = techniques;
        for (const Effect& e : effectsOf(scene, lens, &rest)) {
            if (e.name == name) {
                EXPECT_FALSE(e.simulated) << name;
            }
        }
        for (const Effect& e : effects) {
            if (e.name != name) continue;
            EXPECT_FALSE(e.simulated);
            EXPECT_TRUE(e.reason.starts_with("off by --effect")) << e.reason;
        }
        // Forcing it off once more warns of nothing.
        EXPECT_TRUE(forceEffects(off, {scene, lens, &techniques}, effects).empty());
    }
}

TEST(EffectSwitches, WhatCannotBeForcedIsRefused) {
    const auto force = [](const char* name, bool on) {
        SceneDescription scene = everything();
        scene.environment.reset();
        double lens = 0.0;
        auto effects = effectsOf(scene, lens, nullptr);
        const std::vector<EffectSwitch> one = {{name, on}};
        return forceEffects(one, {scene, lens, nullptr}, effects);
    };
    EXPECT_THROW(force("nonsense", false), UsageError);
    EXPECT_THROW(force("environment", true), UsageError);
    EXPECT_THROW(force("thin_lens", true), UsageError);
    EXPECT_THROW(force("hits", false), UsageError);  // no method, no techniques
    EXPECT_TRUE(force("glossy", true).empty());      // is on already
}

using RenderEffects = RenderTool;

TEST_F(RenderEffects, ForcedOnThePictureStaysTheSame) {
    const auto switches = [](std::initializer_list<const char*> names) {
        std::string text;
        for (const char* name : names) text += std::string(" --effect ") + name + "=on";
        return text;
    };
    // If iterations share light paths, the standard error needs at least two blocks.
    const std::string apart = " --block-iterations 1";
    for (const MethodRow& row : methods()) {
        ASSERT_EQ(run(quick(row.name, "--quiet" + apart)).exitCode, 0);
        const Image plain = readImage(path("out.exr"));
        const auto forcedBy = [&](std::initializer_list<const char*> names) {
            const Outcome o = run(quick(row.name, "--json @o.json" + apart + switches(names)));
            EXPECT_EQ(o.exitCode, 0) << o.err;
            EXPECT_EQ(o.err.find("lacks"), std::string::npos) << o.err;
            return readImage(path("out.exr"));
        };
        const Image forced = forcedBy(
            {"alpha_mask", "emissive_textures", "vertex_colors", "normal_maps", "attenuation"});
        const auto simulated = json("o.json")["effects"]["simulated"];
        EXPECT_NE(std::find(simulated.begin(), simulated.end(), "normal_maps"), simulated.end());
        // The same random numbers give the same paths, except for rounding. If rounding decides which of two equal
        // probabilities is larger (in icbpt), other light vertices are picked.
        double difference = 0.0, sum = 0.0, forcedSum = 0.0;
        for (std::size_t i = 0; i < plain.pixels.size(); ++i) {
            difference += std::fabs(mean(plain.pixels[i]) - mean(forced.pixels[i]));
            sum += mean(plain.pixels[i]);
            forcedSum += mean(forced.pixels[i]);
        }
        if (row.name != "icbpt") {
            EXPECT_LT(difference, 1e-3 * sum) << row.name;
        }
        // Textured surfaces may be smooth somewhere, so ways over them are searched for, and other samples are drawn.
        double texturedSum = 0.0;
        for (const Rgb& p : forcedBy({"textures"}).pixels) texturedSum += double(mean(p));
        const auto error = json("o.json")["mean_rgb_stderr"].get<std::vector<double>>();
        const double allowed = 5.0 * error[0] * double(plain.pixels.size());
        EXPECT_NEAR(forcedSum, sum, allowed) << row.name;
        EXPECT_NEAR(texturedSum, sum, std::sqrt(2.0) * allowed) << row.name;
    }
}

TEST_F(RenderEffects, ForcedOffThePictureAndItsHeaderLackIt) {
    const Outcome o = run(quick("bpt", "--json @o.json --effect area_lights=off"));
    ASSERT_EQ(o.exitCode, 0) << o.err;
    EXPECT_NE(o.err.find("warning: "), std::string::npos);
    EXPECT_NE(o.err.find("area_lights is off though the scene calls for it"), std::string::npos);
    for (const Rgb& p : readImage(path("out.exr")).pixels) ASSERT_TRUE(isBlack(p));
    EXPECT_TRUE(json("o.json")["effects"]["reasons"]["area_lights"].get<std::string>().starts_with(
        "off by --effect"));
    // Without connections, bpt still has hits and splats.
    ASSERT_EQ(run(quick("bpt", "--quiet --effect connections=off")).exitCode, 0);
    double sum = 0.0;
    for (const Rgb& p : readImage(path("out.exr")).pixels) sum += mean(p);
    EXPECT_GT(sum, 0.0);
    expectFailure(quick("bpt", "--effect fog=off"), 2, "--effect fog");
    expectFailure(quick("bpt", "--effect hits=maybe"), 2, "NAME=on or NAME=off");
    // The former spelling.
    expectFailure(quick("bpt", "--set effects.hits=off"), 2, "--effect hits=off");
    expectFailure(quick("pt", "--effect splats=on"), 2, "t = 1");
}

}  // namespace
}  // namespace lacuna::test
