// Materials with their extensions, and textures.
#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {
namespace {

/// A triangle whose material is `material`.
TriangleBuilder withMaterial(const json& material) {
    TriangleBuilder b;
    b.primitive()["material"] = b.add("materials", material);
    return b;
}

Material loadMaterial(const json& material) {
    const SceneDescription scene = withMaterial(material).load();
    expectValid(scene);
    return scene.materials[0];
}

SceneDescription loadExtension(const char* name, const json& value) {
    return withMaterial({{"extensions", {{name, value}}}}).load();
}

/// 2 x 1 picture: red half transparent, then blue.
ByteVector redBlue() {
    return png(2, 1, {255, 0, 0, 128, 0, 0, 255, 255});
}

TEST(Material, DefaultsAreGltfs) {
    const Material m = loadMaterial(json::object());
    EXPECT_EQ(m.baseColor, Rgb(1.0f));
    EXPECT_EQ(m.baseAlpha, 1.0f);
    EXPECT_EQ(m.metallic, 1.0f);
    EXPECT_EQ(m.roughness, 1.0f);
    EXPECT_EQ(m.specular, 1.0f);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_EQ(m.transmission, 0.0f);
    EXPECT_TRUE(m.thin);
    EXPECT_TRUE(isBlack(m.emission));
    EXPECT_FALSE(m.doubleSided);
    EXPECT_EQ(m.alphaMode, Material::Alpha::Opaque);
    EXPECT_EQ(m.alphaCutoff, 0.5f);
    EXPECT_FALSE(m.baseColorTexture || m.metallicRoughnessTexture || m.transmissionTexture ||
                 m.emissiveTexture);
}

TEST(Material, CoreProperties) {
    const Material m = loadMaterial({{"name", "paint"},
                                     {"doubleSided", true},
                                     {"alphaMode", "MASK"},
                                     {"alphaCutoff", 0.25},
                                     {"emissiveFactor", {0.5, 0.25, 1.0}},
                                     {"pbrMetallicRoughness",
                                      {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                                       {"metallicFactor", 0.6},
                                       {"roughnessFactor", 0.7}}}});
    EXPECT_EQ(m.name, "paint");
    EXPECT_TRUE(m.doubleSided);
    EXPECT_EQ(m.alphaMode, Material::Alpha::Mask);
    EXPECT_EQ(m.alphaCutoff, 0.25f);
    EXPECT_EQ(m.emission, Rgb(0.5f, 0.25f, 1.0f));
    EXPECT_EQ(m.baseColor, Rgb(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.baseAlpha, 0.4f);
    EXPECT_EQ(m.metallic, 0.6f);
    EXPECT_EQ(m.roughness, 0.7f);
}

TEST(Material, EmissiveStrengthMultiplies) {
    const Material m = loadMaterial(
        {{"emissiveFactor", {0.5, 0.25, 1.0}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 40}}}}}});
    EXPECT_EQ(m.emission, Rgb(20.0f, 10.0f, 40.0f));
}

TEST(Material, MayBeHiddenFromTheCamera) {
    EXPECT_FALSE(loadMaterial(nlohmann::json::object()).hiddenFromCamera);
    EXPECT_TRUE(
        loadMaterial({{"extras", {{"lacuna", {{"hidden_from_camera", true}}}}}}).hiddenFromCamera);
}

TEST(Material, ExtrasMayBeATextAndNameALightGroup) {
    const auto with = [](const json& lacuna) {
        return loadMaterial({{"extras", {{"lacuna", lacuna}}}});
    };
    EXPECT_EQ(loadMaterial(json::object()).lightGroup, "");
    EXPECT_EQ(with({{"light_group", "key"}}).lightGroup, "key");
    const Material m = with(R"({"light_group": "rim", "hidden_from_camera": true})");
    EXPECT_EQ(m.lightGroup, "rim");
    EXPECT_TRUE(m.hiddenFromCamera);
}

TEST(Material, TransmissionIorVolumeSpecular) {
    const Material m = loadMaterial({{"extensions",
                                      {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                       {"KHR_materials_ior", {{"ior", 1.33}}},
                                       {"KHR_materials_volume", {{"thicknessFactor", 0.5}}},
                                       {"KHR_materials_specular", {{"specularFactor", 0}}}}}});
    EXPECT_EQ(m.transmission, 1.0f);
    EXPECT_EQ(m.ior, 1.33f);
    EXPECT_FALSE(m.thin);
    EXPECT_EQ(m.specular, 0.0f);
    EXPECT_TRUE(loadExtension("KHR_materials_volume", {{"thicknessFactor", 0}}).materials[0].thin);
    EXPECT_TRUE(loadExtension("KHR_materials_volume", json::object()).materials[0].thin);
}

TEST(Material, SpecularColourAndItsTextures) {
    TriangleBuilder b;
    const json info = {{"index", b.texture(redBlue())}};
    json specular = {{"specularFactor", 0.5},
                     {"specularColorFactor", {1, 0.5, 3}},
                     {"specularTexture", info},
                     {"specularColorTexture", info}};
    b.add("materials", {{"extensions", {{"KHR_materials_specular", specular}}}});
    specular["specularFactor"] = 0;
    specular["specularColorFactor"] = {1, -1, 1};
    b.add("materials", {{"extensions", {{"KHR_materials_specular", specular}}}});
    const SceneDescription scene = b.load();
    const Material& m = scene.materials[0];
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(m.specular, 0.5f);
    EXPECT_EQ(m.specularColor, Rgb(1, 0.5f, 3));
    ASSERT_TRUE(m.specularTexture && m.specularColorTexture);
    EXPECT_FALSE(scene.textures[std::size_t(m.specularTexture.value)].srgb);
    EXPECT_TRUE(scene.textures[std::size_t(m.specularColorTexture.value)].srgb);
    // Without the layer its colour has no effect.
    EXPECT_FALSE(scene.materials[1].specularTexture || scene.materials[1].specularColorTexture);
    EXPECT_EQ(
        warningsWith(
            withMaterial({{"extensions",
                           {{"KHR_materials_specular", {{"specularColorFactor", {1, -1, 1}}}}}}})
                .load(),
            "clamped"),
        1);
    expectRefused(
        withMaterial(
            {{"extensions", {{"KHR_materials_specular", {{"specularTexture", {{"index", 7}}}}}}}}),
        {"specularTexture.index", "textures"});
}

TEST(Material, ClearcoatAndItsTextures) {
    TriangleBuilder b;
    const json info = {{"index", b.texture(redBlue())}};
    json coat = {{"clearcoatFactor", 0.5},
                 {"clearcoatTexture", info},
                 {"clearcoatRoughnessFactor", 0.25},
                 {"clearcoatRoughnessTexture", info}};
    b.add("materials", {{"extensions", {{"KHR_materials_clearcoat", coat}}}});
    coat["clearcoatFactor"] = 0;
    b.add("materials",
          {{"normalTexture", info}, {"extensions", {{"KHR_materials_clearcoat", coat}}}});
    const SceneDescription scene = b.load();
    EXPECT_TRUE(scene.warnings.empty());
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.clearcoat, 0.5f);
    EXPECT_EQ(m.clearcoatRoughness, 0.25f);
    ASSERT_TRUE(m.clearcoatTexture && m.clearcoatRoughnessTexture);
    EXPECT_FALSE(scene.textures[std::size_t(m.clearcoatTexture.value)].srgb);
    EXPECT_FALSE(scene.materials[1].clearcoatTexture);
    EXPECT_FALSE(hasOwnClearcoatNormal(m));
    EXPECT_FALSE(hasOwnClearcoatNormal(scene.materials[1]));
    // Over a normal map lacquer is as smooth as the mesh, or has a normal map of its own.
    coat["clearcoatFactor"] = 1;
    b.add("materials",
          {{"normalTexture", info}, {"extensions", {{"KHR_materials_clearcoat", coat}}}});
    coat["clearcoatNormalTexture"] = {{"index", info["index"]}, {"scale", 0.5}};
    b.add("materials", {{"extensions", {{"KHR_materials_clearcoat", coat}}}});
    const SceneDescription lacquers = b.load();
    EXPECT_TRUE(lacquers.warnings.empty());
    EXPECT_TRUE(hasOwnClearcoatNormal(lacquers.materials[2]));
    EXPECT_FALSE(lacquers.materials[2].clearcoatNormalTexture);
    EXPECT_TRUE(hasOwnClearcoatNormal(lacquers.materials[3]));
    ASSERT_TRUE(lacquers.materials[3].clearcoatNormalTexture);
    EXPECT_EQ(lacquers.materials[3].clearcoatNormalScale, 0.5f);
}

/// Files of games have a texture of roughness on everything: only where it has a smooth texel may there be mirrors.
TEST(Material, TexturesOfRoughnessTellWhereMirrorsMayBe) {
    TriangleBuilder b;
    const auto green = [&](std::uint8_t first, std::uint8_t second) {
        const json texture = {
            {"index", b.texture(png(2, 1, {0, first, 0, 255, 0, second, 0, 255}))}};
        return texture;
    };
    const auto addMetal = [&](const json& texture, double factor) {
        b.add("materials",
              {{"pbrMetallicRoughness",
                {{"metallicRoughnessTexture", texture}, {"roughnessFactor", factor}}}});
    };
    const auto addLacquer = [&](const json& texture) {
        b.add("materials", {{"extensions",
                             {{"KHR_materials_clearcoat",
                               {{"clearcoatFactor", 1},
                                {"clearcoatRoughnessFactor", 1},
                                {"clearcoatRoughnessTexture", texture}}}}}});
    };
    const json rough = green(90, 200), smooth = green(200, 0);
    addMetal(rough, 1);
    addMetal(rough, 0.02);  // times 90 / 255 it is below .01
    addMetal(smooth, 1);
    addLacquer(rough);
    addLacquer(smooth);
    const SceneDescription scene = b.load();
    EXPECT_TRUE(scene.warnings.empty());
    std::vector<bool> found;
    for (const Material& m : scene.materials) found.push_back(mayBeSpecular(m));
    EXPECT_EQ(found,
              (std::vector<bool>{false, true, true, false, true, false}));  // and the default
}

TEST(Material, SheenAndItsTextures) {
    TriangleBuilder b;
    const json info = {{"index", b.texture(redBlue())}};
    json sheen = {{"sheenColorFactor", {0.5, 0.25, 2}},
                  {"sheenColorTexture", info},
                  {"sheenRoughnessFactor", 0.75},
                  {"sheenRoughnessTexture", info}};
    b.root["extensionsRequired"] = {"KHR_materials_sheen"};
    b.add("materials", {{"extensions", {{"KHR_materials_sheen", sheen}}}});
    sheen.erase("sheenColorFactor");  // black by default
    b.add("materials", {{"extensions", {{"KHR_materials_sheen", sheen}}}});
    const SceneDescription scene = b.load();
    EXPECT_EQ(warningsWith(scene, "clamped"), 1);
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.sheenColor, Rgb(0.5f, 0.25f, 1.0f));
    EXPECT_EQ(m.sheenRoughness, 0.75f);
    ASSERT_TRUE(m.sheenColorTexture && m.sheenRoughnessTexture);
    EXPECT_TRUE(scene.textures[std::size_t(m.sheenColorTexture.value)].srgb);
    EXPECT_FALSE(scene.textures[std::size_t(m.sheenRoughnessTexture.value)].srgb);
    EXPECT_TRUE(hasSheen(m));
    EXPECT_FALSE(hasSheen(scene.materials[1]));
    EXPECT_FALSE(scene.materials[1].sheenColorTexture);
    expectRefused(
        withMaterial(
            {{"extensions",
              {{"KHR_materials_sheen",
                {{"sheenColorFactor", {1, 1, 1}}, {"sheenColorTexture", {{"index", 7}}}}}}}}),
        {"sheenColorTexture.index", "textures"});
    expectRefused(
        withMaterial({{"extensions", {{"KHR_materials_sheen", {{"sheenColorFactor", {1, 1}}}}}}}),
        {"sheenColorFactor", "3 numbers"});
}

TEST(Material, AnisotropyAndItsTexture) {
    TriangleBuilder b;
    const json info = {{"index", b.texture(redBlue())}};
    b.root["extensionsRequired"] = {"KHR_materials_anisotropy"};
    b.add("materials", {{"extensions",
                         {{"KHR_materials_anisotropy",
                           {{"anisotropyStrength", 0.5},
                            {"anisotropyRotation", -7.5},
                            {"anisotropyTexture", info}}}}}});
    b.add("materials",
          {{"extensions",
            {{"KHR_materials_anisotropy", {{"anisotropyTexture", info}}}}}});  // of strength 0
    const SceneDescription scene = b.load();
    EXPECT_TRUE(scene.warnings.empty());
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.anisotropy, 0.5f);
    EXPECT_EQ(m.anisotropyRotation, -7.5f);
    ASSERT_TRUE(m.anisotropyTexture);
    EXPECT_FALSE(scene.textures[std::size_t(m.anisotropyTexture.value)].srgb);
    EXPECT_FALSE(scene.materials[1].anisotropyTexture);
    expectRefused(
        withMaterial(
            {{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", "much"}}}}}}),
        {"anisotropyStrength", "a number"});
}

TEST(Material, DiffuseTransmissionAndItsTextures) {
    TriangleBuilder b;
    const json info = {{"index", b.texture(redBlue())}};
    b.root["extensionsRequired"] = {"KHR_materials_diffuse_transmission"};
    b.add("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                        {"extensions",
                         {{"KHR_materials_diffuse_transmission",
                           {{"diffuseTransmissionFactor", 0.25},
                            {"diffuseTransmissionTexture", info},
                            {"diffuseTransmissionColorFactor", {1, 0.5, 0}},
                            {"diffuseTransmissionColorTexture", info}}},
                          {"KHR_materials_volume",
                           {{"thicknessFactor", 1},
                            {"attenuationDistance", 1},
                            {"attenuationColor", {1, 1, 0.5}}}}}}});
    const SceneDescription scene = b.load();
    EXPECT_TRUE(scene.warnings.empty());
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.diffuseTransmission, 0.25f);
    EXPECT_EQ(m.diffuseTransmissionColor, Rgb(1.0f, 0.5f, 0.0f));
    ASSERT_TRUE(m.diffuseTransmissionTexture && m.diffuseTransmissionColorTexture);
    EXPECT_FALSE(scene.textures[std::size_t(m.diffuseTransmissionTexture.value)].srgb);
    EXPECT_TRUE(scene.textures[std::size_t(m.diffuseTransmissionColorTexture.value)].srgb);
    EXPECT_TRUE(mayTransmitDiffusely(m));
    EXPECT_NEAR(m.absorption.b, std::log(2.0), 1e-6);  // of light that went in diffusely
}

TEST(Material, AttenuationOfSolidGlass) {
    const auto load = [](json volume, double transmission = 1) {
        volume["attenuationColor"] = {0.5, 1, 0};
        return withMaterial(
                   {{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                    {"extensions",
                     {{"KHR_materials_transmission", {{"transmissionFactor", transmission}}},
                      {"KHR_materials_volume", volume}}}})
            .load();
    };
    const SceneDescription scene = load({{"thicknessFactor", 1}, {"attenuationDistance", 2}});
    EXPECT_TRUE(scene.warnings.empty());
    const Rgb absorption = scene.materials[0].absorption;
    EXPECT_NEAR(std::exp(-2 * absorption.r), 0.5, 1e-6);
    EXPECT_EQ(absorption.g, 0.0f);
    EXPECT_EQ(std::exp(-1e-20f * absorption.b), 0.0f);
    // Sheets, opaque bodies and endless distances absorb nothing.
    EXPECT_TRUE(isBlack(load({{"attenuationDistance", 2}}).materials[0].absorption));
    EXPECT_TRUE(isBlack(
        load({{"thicknessFactor", 1}, {"attenuationDistance", 2}}, 0).materials[0].absorption));
    EXPECT_TRUE(isBlack(load({{"thicknessFactor", 1}}).materials[0].absorption));
    const SceneDescription zero = load({{"thicknessFactor", 1}, {"attenuationDistance", 0}});
    EXPECT_TRUE(isBlack(zero.materials[0].absorption));
    EXPECT_EQ(warningsWith(zero, "attenuationDistance 0"), 1);
}

TEST(Material, IorZeroIsATotalReflectorAndBelowOneIsRefused) {
    const SceneDescription scene = loadExtension("KHR_materials_ior", {{"ior", 0}});
    EXPECT_EQ(scene.materials[0].ior, 1000.0f);
    EXPECT_EQ(warningsWith(scene, "ior 0"), 1);
    for (const double bad : {0.5, -1.0, 0.999}) {
        const auto b = withMaterial({{"extensions", {{"KHR_materials_ior", {{"ior", bad}}}}}});
        expectRefused(b, {"materials[0]", "ior", "at least 1"});
    }
}

TEST(Material, FactorsAreClampedWithOneWarning) {
    TriangleBuilder b = withMaterial({{"emissiveFactor", {3, -1, 0.5}},
                                      {"pbrMetallicRoughness",
                                       {{"baseColorFactor", {2, 0.5, -1, 1}},
                                        {"metallicFactor", 1.5},
                                        {"roughnessFactor", -2}}}});
    const SceneDescription scene = b.load();
    expectValid(scene);
    EXPECT_EQ(scene.materials[0].baseColor, Rgb(1.0f, 0.5f, 0.0f));
    EXPECT_EQ(scene.materials[0].emission, Rgb(1.0f, 0.0f, 0.5f));
    EXPECT_EQ(scene.materials[0].metallic, 1.0f);
    EXPECT_EQ(scene.materials[0].roughness, 0.0f);
    EXPECT_EQ(warningsWith(scene, "clamped (6 times, first materials[0].baseColorFactor)"), 1);
    EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(Material, WhatIsNotRenderedYetIsSaidOncePerKind) {
    TriangleBuilder b;
    const int t = b.texture(redBlue());
    const json info = {{"index", t}};
    const json material = {
        {"alphaMode", "BLEND"},
        {"occlusionTexture", info},
        {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", t}, {"texCoord", 2}}}}},
        {"extensions",
         {{"KHR_materials_volume",
           {{"thicknessFactor", 1},
            {"attenuationDistance", 2},
            {"attenuationColor", {1, 0, 0}},
            {"thicknessTexture", info}}}}}};
    b.add("materials", material);
    b.add("materials", material);
    const SceneDescription scene = b.load();
    for (const char* kind : {"coordinate sets", "thickness textures"}) {
        EXPECT_EQ(warningsWith(scene, kind), 1) << kind;
    }
    EXPECT_EQ(warningsWith(scene, "2 times"), 2);
    EXPECT_EQ(warningsWith(scene, "cclusion"), 0);
    EXPECT_EQ(scene.warnings.size(), 2u);
    EXPECT_EQ(scene.materials[0].alphaMode, Material::Alpha::Blend);
}

TEST(Material, DefaultsOfUnrenderedExtensionsAreNoNews) {
    TriangleBuilder b;
    const json info = {
        {"index", b.texture(redBlue())},
        {"extensions",
         {{"KHR_texture_transform", {{"offset", {0, 0}}, {"rotation", 0}, {"scale", {1, 1}}}}}}};
    b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", info}}},
                        {"extensions",
                         {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0}}},
                          {"KHR_materials_specular", {{"specularColorFactor", {1, 1, 1}}}},
                          {"KHR_materials_volume", {{"attenuationColor", {1, 0, 0}}}}}}});
    EXPECT_TRUE(b.load().warnings.empty());
}

TEST(Material, UnknownExtensions) {
    TriangleBuilder b;
    b.root["extensionsUsed"] = {"VENDOR_bar", "KHR_materials_ior", "EXT_foo",
                                "KHR_materials_iridescence", "KHR_xmp_json_ld"};
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.warnings.size(), 2u);
    EXPECT_EQ(warningsWith(scene, "VENDOR_bar, EXT_foo"), 1);
    EXPECT_EQ(warningsWith(scene,
                           "KHR_materials_iridescence is not rendered: thin films have no colours"),
              1);
    b.root["extensionsRequired"] = {"KHR_materials_ior", "KHR_mesh_quantization"};
    EXPECT_NO_THROW(b.load());
    b.root["extensionsRequired"] = {"KHR_materials_ior", "EXT_texture_avif"};
    expectRefused(b, {"extensionsRequired", "EXT_texture_avif"});
    b.root["extensionsRequired"] = {"KHR_materials_clearcoat"};
    EXPECT_NO_THROW(b.load());
}

json placedTexture(int index, const json& transform) {
    return {{"index", index}, {"extensions", {{"KHR_texture_transform", transform}}}};
}

TEST(Material, TexturesArePlaced) {
    constexpr double kQuarter = 1.57079632679489662;
    TriangleBuilder b;
    b.root["extensionsRequired"] = {"KHR_texture_transform"};
    const int t = b.texture(redBlue());
    const json moved = {{"offset", {0.25, -1}}, {"scale", {2, 3}}};
    // The specification's own example: the image's lower left quadrant, turned clockwise by 90
    // degrees. v points down.
    const json quadrant = {{"offset", {0, 1}}, {"rotation", kQuarter}, {"scale", {0.5, 0.5}}};
    const json scaledThenTurned = {{"rotation", kQuarter}, {"scale", {2, 1}}};
    const json metal = {
        {"KHR_materials_transmission",
         {{"transmissionFactor", 1}, {"transmissionTexture", placedTexture(t, moved)}}}};
    b.add("materials", {{"pbrMetallicRoughness",
                         {{"baseColorTexture", placedTexture(t, moved)},
                          {"metallicRoughnessTexture", placedTexture(t, quadrant)}}},
                        {"normalTexture", placedTexture(t, scaledThenTurned)},
                        {"emissiveFactor", {1, 1, 1}},
                        {"emissiveTexture", placedTexture(t, moved)},
                        {"extensions", metal}});
    const SceneDescription scene = b.load();
    const Material& m = scene.materials[0];
    EXPECT_TRUE(scene.warnings.empty());
    const auto expectAt = [](const TextureUse& use, Vec2 from, Vec2 to) {
        ASSERT_TRUE(use);
        EXPECT_NEAR(use.at(from).x, to.x, 1e-6) << from.x << " " << from.y;
        EXPECT_NEAR(use.at(from).y, to.y, 1e-6) << from.x << " " << from.y;
    };
    for (const TextureUse& use : {m.baseColorTexture, m.emissiveTexture, m.transmissionTexture}) {
        expectAt(use, {0, 0}, {0.25f, -1});
        expectAt(use, {1, 1}, {2.25f, 2});
    }
    expectAt(m.metallicRoughnessTexture, {0, 0}, {0, 1});
    expectAt(m.metallicRoughnessTexture, {1, 0}, {0, 0.5f});
    expectAt(m.metallicRoughnessTexture, {0, 1}, {0.5f, 1});
    expectAt(m.metallicRoughnessTexture, {1, 1}, {0.5f, 0.5f});
    expectAt(m.normalTexture, {1, 0}, {0, -2});
    expectAt(m.normalTexture, {0, 1}, {1, 0});
}

TEST(Material, BadPlacesOfTexturesAreRefused) {
    for (const json& wrong :
         {json{{"scale", 2}}, json{{"offset", {1, 2, 3}}}, json{{"rotation", "left"}}, json(3)}) {
        TriangleBuilder b;
        const int t = b.texture(redBlue());
        b.add("materials", {{"normalTexture", placedTexture(t, wrong)}});
        expectRefused(b, {"materials[0]"});
    }
    TriangleBuilder b;
    const int t = b.texture(redBlue());
    b.add("materials", {{"normalTexture", placedTexture(t, {{"texCoord", 2}})}});
    EXPECT_EQ(warningsWith(b.load(), "coordinate sets"), 1);
}

TEST(Material, TexturesLieByTheirCoordinateSet) {
    TriangleBuilder b;
    const int t = b.texture(redBlue());
    json placed = placedTexture(t, {{"texCoord", 0}});
    placed["texCoord"] = 1;  // the transform's own overrides it
    b.add("materials", {{"pbrMetallicRoughness",
                         {{"baseColorTexture", {{"index", t}, {"texCoord", 1}}},
                          {"metallicRoughnessTexture", {{"index", t}, {"texCoord", 0}}}}},
                        {"normalTexture", placedTexture(t, {{"texCoord", 1}})},
                        {"emissiveFactor", {1, 1, 1}},
                        {"emissiveTexture", placed}});
    const SceneDescription scene = b.load();
    const Material& m = scene.materials[0];
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_TRUE(m.baseColorTexture.secondSet);
    EXPECT_FALSE(m.metallicRoughnessTexture.secondSet);
    EXPECT_TRUE(m.normalTexture.secondSet);
    EXPECT_FALSE(m.emissiveTexture.secondSet);
}

TEST(Material, NormalMap) {
    TriangleBuilder b;
    const int t = b.texture(redBlue());
    b.add("materials", {{"normalTexture", {{"index", t}, {"scale", 0.5}}}});
    const SceneDescription scene = b.load();
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_TRUE(scene.materials[0].normalTexture);
    EXPECT_EQ(scene.materials[0].normalScale, 0.5f);
    EXPECT_FALSE(scene.textures[std::size_t(scene.materials[0].normalTexture.value)].srgb);
}

TEST(Material, BadValuesAreRefused) {
    expectRefused(withMaterial({{"alphaMode", "GLASS"}}), {"alphaMode", "GLASS"});
    expectRefused(withMaterial({{"alphaMode", 3}}), {"materials[0].alphaMode", "a string"});
    expectRefused(withMaterial({{"doubleSided", 1}}), {"doubleSided", "true or false"});
    expectRefused(withMaterial({{"emissiveFactor", {1, 2}}}), {"emissiveFactor", "3 numbers"});
    expectRefused(withMaterial({{"emissiveFactor", {1, 2, "x"}}}), {"3 numbers"});
    expectRefused(withMaterial({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1}}}}}),
                  {"baseColorFactor", "4 numbers"});
    expectRefused(withMaterial({{"pbrMetallicRoughness", {{"roughnessFactor", "rough"}}}}),
                  {"roughnessFactor", "a number"});
    expectRefused(withMaterial({{"extensions", {{"KHR_materials_ior", {{"ior", "glass"}}}}}}),
                  {"ior", "a number"});
    expectRefused(withMaterial({{"extensions", {{"KHR_materials_ior", 1.5}}}}), {"an object"});
    expectRefused(withMaterial({{"extensions",
                                 {{"KHR_materials_specular", {{"specularColorFactor", {1, 1}}}}}}}),
                  {"specularColorFactor", "3 numbers"});
}

TEST(Texture, TexelsWrapAndCodingByUse) {
    TriangleBuilder b;
    const int t = b.texture(redBlue(), {{"wrapS", 33071}, {"wrapT", 33648}});
    const json info = {{"index", t}};
    b.add("materials", {{"emissiveFactor", {1, 1, 1}},
                        {"emissiveTexture", info},
                        {"pbrMetallicRoughness",
                         {{"baseColorTexture", info}, {"metallicRoughnessTexture", info}}},
                        {"extensions",
                         {{"KHR_materials_transmission",
                           {{"transmissionFactor", 0.5}, {"transmissionTexture", info}}}}}});
    const SceneDescription scene = b.load();
    expectValid(scene);
    ASSERT_EQ(scene.textures.size(), 2u);  // one as colour, one as data
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.baseColorTexture.value, m.emissiveTexture.value);
    EXPECT_EQ(m.metallicRoughnessTexture.value, m.transmissionTexture.value);
    const Texture& color = scene.textures[std::size_t(m.baseColorTexture.value)];
    const Texture& data = scene.textures[std::size_t(m.metallicRoughnessTexture.value)];
    EXPECT_TRUE(color.srgb);
    EXPECT_FALSE(data.srgb);
    for (const Texture& texture : {color, data}) {
        EXPECT_EQ(texture.width, 2);
        EXPECT_EQ(texture.height, 1);
        EXPECT_EQ(texture.rgba, (ByteVector{255, 0, 0, 128, 0, 0, 255, 255}));
        EXPECT_EQ(texture.wrapU, Texture::Wrap::ClampToEdge);
        EXPECT_EQ(texture.wrapV, Texture::Wrap::MirroredRepeat);
    }
}

TEST(Texture, SquareTexelsWhereTheFilterSaysSo) {
    TriangleBuilder b;
    for (const int filter : {9728, 9729}) {
        const int t = b.texture(redBlue(), {{"magFilter", filter}, {"minFilter", 9728}});
        b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", t}}}}}});
    }
    const SceneDescription scene = b.load();
    ASSERT_EQ(scene.textures.size(), 2u);
    EXPECT_TRUE(scene.textures[0].nearest);
    EXPECT_FALSE(scene.textures[1].nearest);
}

TEST(Texture, SharedByImageAndSampler) {
    TriangleBuilder b;
    const int first = b.texture(redBlue());
    const int same = b.add("textures", {{"source", 0}});
    const int clamped =
        b.add("textures", {{"source", 0}, {"sampler", b.add("samplers", {{"wrapS", 33071}})}});
    for (const int t : {first, same, clamped}) {
        b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", t}}}}}});
    }
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.textures.size(), 2u);
    EXPECT_EQ(scene.materials[0].baseColorTexture.value, scene.materials[1].baseColorTexture.value);
    EXPECT_NE(scene.materials[0].baseColorTexture.value, scene.materials[2].baseColorTexture.value);
    EXPECT_EQ(scene.textures[1].rgba, scene.textures[0].rgba);
    EXPECT_EQ(scene.textures[0].wrapU, Texture::Wrap::Repeat);
}

TEST(Texture, WhatMultipliesBlackIsNotDecoded) {
    TriangleBuilder b;
    const json info = {{"index", b.texture({1, 2, 3})}};  // not even an image
    b.add("materials",
          {{"emissiveTexture", info},
           {"extensions", {{"KHR_materials_transmission", {{"transmissionTexture", info}}}}}});
    const SceneDescription scene = b.load();
    EXPECT_TRUE(scene.textures.empty());
    EXPECT_FALSE(scene.materials[0].emissiveTexture);
}

TriangleBuilder withImage(const ByteVector& image, const json& sampler = {}) {
    TriangleBuilder b;
    const int t = b.texture(image, sampler);
    b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", t}}}}}});
    return b;
}

TEST(Texture, DamagedImagesAreRefused) {
    EXPECT_NO_THROW(withImage(redBlue()).load());
    expectRefused(withImage({}), {"images[0]", "PNG, JPEG or WebP"});
    expectRefused(withImage({'G', 'I', 'F', '8', '9', 'a', 0, 0}),
                  {"images[0]", "PNG, JPEG or WebP"});
    ByteVector cut = redBlue();
    for (const std::size_t size : {5ul, 20ul, 40ul, 50ul}) {
        cut = redBlue();
        ASSERT_LT(size, cut.size());
        cut.resize(size);
        expectRefused(withImage(cut), {"images[0]", "damaged"});
    }
}

TEST(Texture, SizesAreCappedBeforeAnythingIsAllocated) {
    ByteVector huge = redBlue();
    for (const std::size_t at : {16ul, 20ul}) huge[at] = 0, huge[at + 1] = 0xF0;  // 15.7 million
    expectRefused(withImage(huge), {"images[0]"});
    // 20,000 x 20,000 of grey, which stb_image itself would accept.
    ByteVector large = redBlue();
    for (const std::size_t at : {16ul, 20ul}) large[at + 2] = 0x4E, large[at + 3] = 0x20;
    large[25] = 0;
    expectRefused(withImage(large), {"images[0]", "at most 268435456 texels", "20000 x 20000"});
    // 16,384 x 16,384, which would take a gigabyte, in a hundred bytes.
    for (const std::size_t at : {16ul, 20ul}) large[at + 2] = 0x40, large[at + 3] = 0;
    expectRefused(withImage(large), {"images[0]", "at least 260111 bytes", "16384 x 16384"});
    // Texels of one bit fit into 40 kB, and would take four gigabytes.
    large[24] = 1;
    large.resize(40'000);
    expectRefused(withImage(large),
                  {"images[0]", "unpacks to at most 4096 times", "scale the image"});
}

/// A grey JPEG of 8 x 8 texels with this many scans. Each code is one bit and says zero.
ByteVector greyJpeg(int scans) {
    ByteVector bytes{0xFF, 0xD8, 0xFF, 0xDB, 0, 67, 0};
    bytes.insert(bytes.end(), 64, 8);
    bytes.insert(bytes.end(), {0xFF, 0xC0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0});
    bytes.insert(bytes.end(), {0xFF, 0xC4, 0, 38});
    for (const std::uint8_t table : {0x00, 0x10}) {
        bytes.insert(bytes.end(), {table, 1});
        bytes.insert(bytes.end(), 16, 0);
    }
    for (int i = 0; i < scans; ++i) {
        bytes.insert(bytes.end(), {0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 63, 0});
    }
    bytes.insert(bytes.end(), {0xFF, 0xD9});
    return bytes;
}

// Each scan goes over all texels: half a megabyte of empty scans would take minutes.
TEST(Texture, JpegsHaveFewScans) {
    ByteVector grey;
    for (int i = 0; i < 64; ++i) grey.insert(grey.end(), {128, 128, 128, 255});
    EXPECT_EQ(withImage(greyJpeg(64)).load().textures[0].rgba, grey);
    expectRefused(withImage(greyJpeg(65)), {"images[0]", "at most 64 scans", "65"});
    // A comment may hold anything.
    ByteVector commented{0xFF, 0xD8, 0xFF, 0xFE, 0, 202};
    for (int i = 0; i < 100; ++i) commented.insert(commented.end(), {0xFF, 0xDA});
    const ByteVector plain = greyJpeg(1);
    commented.insert(commented.end(), plain.begin() + 2, plain.end());
    EXPECT_EQ(withImage(commented).load().textures[0].rgba, grey);
}

// stb_image has room for 256 codes and does not check. Missing tables are all zeros to it.
TEST(Texture, HuffmanTablesAreChecked) {
    const ByteVector plain = greyJpeg(1);
    const std::ptrdiff_t tables = 2 + 69 + 13;
    ByteVector longTable{0xFF, 0xC4, 255, 255, 0x10};
    longTable.insert(longTable.end(), 14, 0);
    longTable.insert(longTable.end(), {2, 255});
    ByteVector changed = plain;
    changed.insert(changed.begin() + tables, longTable.begin(), longTable.end());
    expectRefused(withImage(changed), {"images[0]", "at most 256 codes"});
    const ByteVector cut(changed.begin(), changed.begin() + tables + 21);
    expectRefused(withImage(cut), {"images[0]", "at most 256 codes"});
    ByteVector without = plain;
    without.erase(without.begin() + tables, without.begin() + tables + 40);
    EXPECT_EQ(withImage(without).load().textures[0].rgba, withImage(plain).load().textures[0].rgba);
}

TEST(Texture, SamplersAndSourcesAreChecked) {
    expectRefused(withImage(redBlue(), {{"wrapS", 10498}}), {"samplers[0].wrapS", "10498"});
    expectRefused(withImage(redBlue(), {{"wrapT", "x"}}), {"samplers[0].wrapT"});
    TriangleBuilder b = withImage(redBlue());
    b.root["images"][0]["uri"] = "a.png";
    expectRefused(b, {"images[0]", "both"});
    b.root["images"][0] = json::object();
    expectRefused(b, {"images[0]", "neither"});
    b.root["textures"][0].erase("source");
    const SceneDescription scene = b.load();
    EXPECT_EQ(warningsWith(scene, "without a PNG, JPEG or WebP image"), 1);
    EXPECT_FALSE(scene.materials[0].baseColorTexture);
}

}  // namespace
}  // namespace lacuna::test
