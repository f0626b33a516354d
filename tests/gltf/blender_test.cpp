// scenes/blender-still-life.glb, as Blender 3.4 exported it: what scenes/make_blender_scene.py made
// arrives, without a warning. And what Blender's exporter (3.4 to 5) writes if its user meant
// something else.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcore/gltf/blender.h"
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
    // Blender exports tangents of all meshes; the loader reads them where a normal map uses them.
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

enum class Mode { Unitless, Standard, Raw };

/// io_scene_gltf2, gather_intensity: the power is a float in Blender, the rest is done in double.
double exported(Mode mode, const std::string& type, float power) {
    double intensity = double(power);
    if (mode == Mode::Raw) return intensity;
    if (type != "directional") intensity /= 4 * std::numbers::pi;
    return mode == Mode::Standard ? intensity * 683 : intensity;
}

struct Lamp {
    std::string type;
    float power;
};

TriangleBuilder fromBlender() {
    TriangleBuilder b;
    b.root["asset"]["generator"] = "Khronos glTF Blender I/O v3.4.50";
    b.add("materials",
          {{"name", "grey"},
           {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.5}}}});
    b.primitive()["material"] = 0;
    return b;
}

TriangleBuilder withLamps(Mode mode, const std::vector<Lamp>& lamps) {
    TriangleBuilder b = fromBlender();
    json& lights = b.root["extensions"]["KHR_lights_punctual"]["lights"];
    for (const Lamp& lamp : lamps) {
        json placed;
        placed["extensions"]["KHR_lights_punctual"]["light"] = lights.size();
        json light = {{"type", lamp.type},
                      {"name", lamp.type + " " + std::to_string(lights.size())},
                      {"intensity", exported(mode, lamp.type, lamp.power)}};
        if (lamp.type == "spot") light["spot"] = json::object();
        lights.push_back(light);
        b.rootNode(placed);
    }
    return b;
}

/// Warnings of lamps that are too bright.
std::string tooBright(const GltfBuilder& b, LampUnits units = LampUnits::Radiometric) {
    std::string found;
    for (const std::string& warning : b.load(units).warnings) {
        if (warning.find("too bright") != std::string::npos) found += warning;
    }
    return found;
}

TEST(BlenderLighting, StandardAndRawAreSaidUnitlessIsNot) {
    // Round and odd powers, as users type them and as they drag them with the mouse.
    const float powers[] = {1.0f, 1000.0f, 40.0f, 0.5f, 12.5f, 37.3f, 7.25f, 1234.5677f, 57.29304f};
    for (const char* type : {"point", "spot", "directional"}) {
        for (const float power : powers) {
            SCOPED_TRACE(type + std::string(" ") + std::to_string(power));
            const std::string standard = tooBright(withLamps(Mode::Standard, {{type, power}}));
            EXPECT_NE(standard.find("lamps are 683 times too bright"), std::string::npos);
            EXPECT_NE(standard.find("Unitless"), std::string::npos);
            EXPECT_NE(standard.find(std::string("'") + type + " 0'"), std::string::npos);
            EXPECT_EQ(tooBright(withLamps(Mode::Unitless, {{type, power}})), "");
            const std::string raw = tooBright(withLamps(Mode::Raw, {{type, power}}));
            // A sun is the same in Raw.
            EXPECT_EQ(raw.find("4 pi times too bright") != std::string::npos,
                      std::string(type) != "directional")
                << raw;
        }
    }
    EXPECT_NE(tooBright(withLamps(Mode::Standard, {{"spot", 37.3f}}))
                  .find("has 25475.9 W here, in Blender 37.3)"),
              std::string::npos);
}

TEST(BlenderLighting, PhotometricLampsAreDividedAndNothingElse) {
    constexpr LampUnits kPhotometric = LampUnits::Photometric;
    const std::vector<Lamp> lamps = {{"point", 1000}, {"spot", 37.3f}, {"directional", 3}};
    const auto shining = [&](Mode mode) {
        TriangleBuilder b = withLamps(mode, lamps);
        b.root["materials"][0]["emissiveFactor"] = {0.25, 0.5, 1.0};
        return b;
    };
    const SceneDescription expected = shining(Mode::Unitless).load();
    const SceneDescription found = shining(Mode::Standard).load(kPhotometric);
    EXPECT_EQ(found.lampUnits, kPhotometric);
    ASSERT_EQ(found.lights.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_FLOAT_EQ(found.lights[i].intensity.g, expected.lights[i].intensity.g);
        EXPECT_EQ(shining(Mode::Standard).load().lights[i].intensity.g,
                  float(exported(Mode::Standard, lamps[i].type, lamps[i].power)));
    }
    EXPECT_EQ(found.materials[0].emission, Rgb(0.25f, 0.5f, 1.0f));
    // Whoever sets the units gets no warning about them; Raw has nothing to do with lumens.
    EXPECT_EQ(tooBright(shining(Mode::Standard), kPhotometric), "");
    EXPECT_NE(tooBright(shining(Mode::Standard)).find("--units photometric"), std::string::npos);
    EXPECT_NE(tooBright(shining(Mode::Raw), kPhotometric).find("4 pi"), std::string::npos);
}

TEST(BlenderLighting, ManyLampsAgreeOrNothingIsSaid) {
    const std::vector<Lamp> lamps = {
        {"point", 1000}, {"spot", 0.1f}, {"directional", 3}, {"point", 0}, {"directional", 0.7f}};
    EXPECT_NE(tooBright(withLamps(Mode::Standard, lamps)).find("683"), std::string::npos);
    EXPECT_EQ(tooBright(withLamps(Mode::Unitless, lamps)), "");
    EXPECT_NE(tooBright(withLamps(Mode::Raw, lamps)).find("4 pi"), std::string::npos);
    // One lamp differs (on purpose, or changed afterwards), so that no setting of the exporter
    // explains them all.
    TriangleBuilder mixed = withLamps(Mode::Standard, lamps);
    mixed.root["extensions"]["KHR_lights_punctual"]["lights"][1]["intensity"] =
        exported(Mode::Unitless, "spot", 0.1f);
    EXPECT_EQ(tooBright(mixed), "");
    // The power of a lamp by nodes is no float. That lamp tells nothing, but the others do.
    mixed = withLamps(Mode::Standard, lamps);
    mixed.root["extensions"]["KHR_lights_punctual"]["lights"][1]["intensity"] =
        100.0 / (16 * std::numbers::pi * std::numbers::pi) * 683;
    EXPECT_NE(tooBright(mixed).find("683"), std::string::npos);
    // Files of other exporters are not judged.
    TriangleBuilder others = withLamps(Mode::Standard, lamps);
    others.root["asset"]["generator"] = "three.js";
    EXPECT_EQ(tooBright(others), "");
    others.root["asset"].erase("generator");
    EXPECT_EQ(tooBright(others), "");
}

/// One lamp per file, with powers as users type them and as they drag them.
TEST(BlenderLighting, FalseAlarmsAreRare) {
    using gltf::BlenderLamp;
    using gltf::lightingOf;
    const auto said = [](Mode mode, bool isSun, float power) {
        const std::string type = isSun ? "directional" : "point";
        return lightingOf({BlenderLamp{isSun, exported(mode, type, power)}});
    };
    int alarms = 0, missed = 0, lamps = 0;
    const auto count = [&](bool isSun, float power) {
        ++lamps;
        alarms += said(Mode::Unitless, isSun, power) != gltf::BlenderLighting::Unitless;
        missed += said(Mode::Standard, isSun, power) != gltf::BlenderLighting::Standard;
    };
    for (const bool isSun : {false, true}) {
        for (int digits = 1; digits < 1000; ++digits) {
            for (const float unit : {0.01f, 0.1f, 1.0f, 10.0f}) count(isSun, float(digits) * unit);
        }
    }
    EXPECT_EQ(lamps, 7992);
    EXPECT_EQ(alarms, 4);  // 683 and 6830, of either kind
    EXPECT_EQ(missed, 0);

    alarms = missed = lamps = 0;
    std::uint32_t bits = 1;
    for (int i = 0; i < 200000; ++i) {
        bits = bits * 1664525u + 1013904223u;
        count(i % 2, std::ldexp(1.0f + float(bits >> 9) * 0x1p-23f, int(bits % 16) - 4));
    }
    // A 683rd of all floats are multiples of 683. The loader takes those for Unitless unless the
    // quotient is one that somebody would type.
    EXPECT_LE(alarms, 4);
    EXPECT_NEAR(missed, lamps / 683, 5 * std::sqrt(lamps / 683));
}

TEST(BlenderMaterials, ShadersThatAreNotExportedAreNamed) {
    // What Blender 3.4 writes of Glass BSDF and of mixtures; Blender 4 leaves the object out.
    TriangleBuilder b = fromBlender();
    const auto use = [&](const json& material) {
        json primitive = b.primitive();
        primitive["material"] = b.add("materials", material);
        b.root["meshes"][0]["primitives"].push_back(primitive);
    };
    EXPECT_EQ(warningsWith(b.load(), "white metal"), 0);
    use({{"name", "glass"}, {"doubleSided", true}, {"pbrMetallicRoughness", json::object()}});
    SceneDescription scene = b.load();
    EXPECT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(warningsWith(scene,
                           "glTF's default: 'glass' (Blender exports no shaders but "
                           "Principled BSDF and Emission"),
              1);
    use({{"name", "mixed"}});
    use({{"name", "third"}});
    EXPECT_EQ(warningsWith(b.load(), "'glass', 'mixed', 'third' ("), 1);
    use({{"name", "fourth"}});
    use({{"name", "fifth"}});
    EXPECT_EQ(warningsWith(b.load(), "'glass', 'mixed', 'third' and 2 more ("), 1);
    // There is no warning about what a lamp reflects, nor about unused materials.
    b = fromBlender();
    use({{"name", "lamp"}, {"emissiveFactor", {1, 1, 1}}});
    b.add("materials", {{"name", "unused"}});
    EXPECT_TRUE(b.load().warnings.empty());
    use({{"name", "unlit"}, {"emissiveFactor", {0, 0, 0}}});
    EXPECT_EQ(warningsWith(b.load(), "'unlit'"), 1);
    b.root["asset"]["generator"] = "by hand";
    EXPECT_EQ(warningsWith(b.load(), "glTF's default: 'unlit'"), 1);
    EXPECT_EQ(warningsWith(b.load(), "Blender"), 0);
}

TEST(BlenderMaterials, ObjectsWithoutOneAreSaid) {
    TriangleBuilder b = fromBlender();
    b.primitive().erase("material");
    EXPECT_EQ(warningsWith(b.load(), "objects without a material are rendered as white metal"), 1);
    b.root["asset"].erase("generator");
    EXPECT_TRUE(b.load().warnings.empty());
}

TEST(BlenderCamera, TheBoxThatWasNotTickedIsNamed) {
    const auto refusal = [](const GltfBuilder& b) -> std::string {
        try {
            requireCamera(b.load());
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    TriangleBuilder b = fromBlender();
    EXPECT_NE(refusal(b).find("Include > Cameras"), std::string::npos) << refusal(b);
    EXPECT_NE(refusal(b).find("expected a perspective camera"), std::string::npos);
    EXPECT_EQ(refusal(TriangleBuilder()).find("Blender"), std::string::npos);
    b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    b.rootNode({{"camera", 0}});
    EXPECT_EQ(refusal(b), "");
}

}  // namespace
}  // namespace lacuna::test
