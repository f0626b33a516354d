#include "tests/gltf/everything.h"

#include <optional>
#include <utility>

#include "libcore/base/parallel.h"
#include "libcore/scene/scene.h"
#include "tests/gltf/packed.h"

namespace lacuna::test {
namespace {

/// Mesh 2 under node 4, which a skin bends and a morph target moves.
void addBentMesh(GltfBuilder& b) {
    const int positions = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    std::vector<float> matrix(16);
    for (const std::size_t i : {0, 5, 10, 15}) matrix[i] = 1;
    b.add("skins", {{"joints", {1, 2}}});
    b.add("skins", {{"joints", {1}},
                    {"inverseBindMatrices",
                     b.add("accessors", {{"bufferView", b.view(test::bytesOf(matrix))},
                                         {"componentType", 5126},
                                         {"count", 1},
                                         {"type", "MAT4"}})}});
    b.mesh({{"attributes",
             {{"POSITION", positions},
              {"JOINTS_0", b.accessor<std::uint8_t>(ByteVector(12), "VEC4")},
              {"WEIGHTS_0", b.accessor<std::uint8_t>(ByteVector(12, 64), "VEC4", true)}}},
            {"targets", {{{"POSITION", positions}}}}});
    b.root["meshes"][2]["weights"] = {0.5};
    b.add("nodes", {{"mesh", 2}, {"skin", 1}});
}

}  // namespace

GltfBuilder everything() {
    GltfBuilder b;
    const int positions = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1}, "VEC3");
    const int normals =
        b.accessor<std::int8_t>({0, 0, 127, 0, 0, 127, 0, 0, 127, 0, 0, 127}, "VEC3", true);
    const int uvs =
        b.accessor<std::uint16_t>({0, 0, 65535, 0, 0, 65535, 65535, 65535}, "VEC2", true);
    const int tangents =
        b.accessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, -1, 0, 0, 0, 0}, "VEC4");
    const int colors = b.accessor<std::uint8_t>(ByteVector(12, 200), "VEC3", true);
    const int places = b.accessor<float>({1, 2, 3}, "VEC3");
    const int indices = b.accessor<std::uint16_t>({0, 1, 2, 2, 1, 3}, "SCALAR");
    b.root["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", b.view(bytesOf<std::uint16_t>({3}))}, {"componentType", 5123}}},
        {"values", {{"bufferView", b.view(bytesOf<float>({2, 2, 2}))}}}};
    const int texture =
        b.texture(png(2, 2, ByteVector(16, 99)), {{"wrapS", 33071}, {"wrapT", 10497}});
    const json info = {{"index", texture}, {"texCoord", 0}};
    const int webpTexture = b.texture(webp(2, 2, ByteVector(16, 77)));
    b.root["textures"][std::size_t(webpTexture)] = {
        {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}};
    const json placed = {
        {"index", webpTexture},
        {"texCoord", 1},
        {"extensions",
         {{"KHR_texture_transform",
           {{"offset", {0.5, 0}}, {"rotation", 1}, {"scale", {2, 3}}, {"texCoord", 1}}}}}};
    b.add("materials",
          {{"name", "all"},
           {"alphaMode", "MASK"},
           {"alphaCutoff", 0.5},
           {"doubleSided", true},
           {"emissiveFactor", {1, 0.5, 0.25}},
           {"emissiveTexture", info},
           {"normalTexture", info},
           {"occlusionTexture", info},
           {"pbrMetallicRoughness",
            {{"baseColorFactor", {0.5, 0.5, 0.5, 1}},
             {"metallicFactor", 0.5},
             {"roughnessFactor", 0.5},
             {"baseColorTexture", info},
             {"metallicRoughnessTexture", info}}},
           {"extensions",
            {{"KHR_materials_ior", {{"ior", 1.5}}},
             {"KHR_materials_emissive_strength", {{"emissiveStrength", 7.0}}},
             {"KHR_materials_specular",
              {{"specularFactor", 0.5}, {"specularColorFactor", {1, 1, 1}}}},
             {"KHR_materials_transmission",
              {{"transmissionFactor", 0.5}, {"transmissionTexture", info}}},
             {"KHR_materials_clearcoat",
              {{"clearcoatFactor", 0.5},
               {"clearcoatRoughnessFactor", 0.5},
               {"clearcoatTexture", placed},
               {"clearcoatNormalTexture", info}}},
             {"KHR_materials_sheen",
              {{"sheenColorFactor", {0.5, 0.5, 1}},
               {"sheenRoughnessFactor", 0.5},
               {"sheenRoughnessTexture", info}}},
             {"KHR_materials_anisotropy",
              {{"anisotropyStrength", 0.5}, {"anisotropyTexture", placed}}},
             {"KHR_materials_diffuse_transmission",
              {{"diffuseTransmissionFactor", 0.5}, {"diffuseTransmissionColorTexture", info}}},
             {"KHR_materials_volume",
              {{"thicknessFactor", 1},
               {"attenuationDistance", 3},
               {"attenuationColor", {1, 0.5, 1}}}}}}});
    const json attributes = {{"POSITION", positions}, {"NORMAL", normals}, {"TANGENT", tangents},
                             {"TEXCOORD_0", uvs},     {"TEXCOORD_1", uvs}, {"COLOR_0", colors}};
    b.mesh({{"attributes", attributes}, {"indices", indices}, {"material", 0}, {"mode", 4}});
    b.root["meshes"][0]["primitives"].push_back({{"attributes", attributes}, {"mode", 5}});
    b.add("cameras", {{"type", "perspective"},
                      {"perspective", {{"yfov", 0.8}, {"aspectRatio", 1.5}, {"znear", 0.1}}}});
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"},
         {"color", {1, 1, 0.5}},
         {"intensity", 10},
         {"range", 100},
         {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.6}}}}};
    b.root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_ior"};
    b.root["extensionsRequired"] = {"KHR_lights_punctual"};
    b.root["scene"] = 0;
    b.rootNode({{"name", "root"}, {"children", {1, 2, 3, 4}}, {"scale", {1, 2, 3}}});
    b.add("nodes", {{"mesh", 0},
                    {"rotation", {0, 0, 0, 1}},
                    {"translation", {1, 2, 3}},
                    {"extensions",
                     {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
    b.add("nodes", {{"camera", 0},
                    {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1}},
                    {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    const int corners = b.accessor<std::uint8_t>({0, 1, 2}, "SCALAR");
    b.mesh({{"attributes", {{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")}}},
            {"indices", corners}});
    b.add("nodes", {{"mesh", 1}});
    packByDraco(b, 1);
    addBentMesh(b);
    packByMeshopt(b, places);
    packByMeshopt(b, indices);
    declareFallback(b);
    b.extras() = {
        {"lacuna",
         {{"width", 64}, {"height", 48}, {"max_depth", 8}, {"aperture", 0.5}, {"focus", 2}}},
        {"author", {{"name", "x"}}}};
    return b;
}

namespace {

std::optional<SceneDescription> loadOrRefuse(const TempDir& dir, const ByteVector& bytes) {
    try {
        SceneDescription scene = loadGltf(dir / "scene.glb", bytes);
        expectValid(scene);
        return scene;
    } catch (const InputError& error) {
        const std::string line = error.what();
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        EXPECT_NE(line.find("expected "), std::string::npos) << line;
        return {};
    }
}

}  // namespace

bool loadsOrIsRefused(const TempDir& dir, const ByteVector& bytes) {
    return loadOrRefuse(dir, bytes).has_value();
}

bool buildsOrIsRefused(const TempDir& dir, const ByteVector& bytes) {
    std::optional<SceneDescription> description = loadOrRefuse(dir, bytes);
    if (!description) return false;
    if (description->environment) {
        // Whatever the file says, nothing outside its folder is opened.
        const std::filesystem::path inside =
            std::filesystem::path(description->environment->file).lexically_relative(dir / "");
        EXPECT_NE(*inside.begin(), "..") << inside;
    }
    // The tables of a dielectric layer take a second with sanitizers and see one clamped number.
    for (Material& m : description->materials) m.specular = 0.0f;
    static const ThreadPool pool(1);
    try {
        const Scene scene(std::move(*description), pool);
    } catch (const InputError& error) {  // an environment that is no picture
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        return false;
    }
    return true;
}

}  // namespace lacuna::test
