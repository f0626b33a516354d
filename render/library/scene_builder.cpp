#include "lacuna/scene_builder.h"

#include <stb/stb_image_write.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/vec.h"

namespace lacuna {
namespace {

using nlohmann::json;

// Constants of glTF (glTF 2.0, 3.6.2.2 and 5.11.5).
constexpr int kFloat = 5126, kUnsignedInt = 5125, kVertices = 34962, kIndices = 34963;

/// A colour with components up to 1 and its scale: glTF's factors go up to 1.
struct Scaled {
    SceneBuilder::Colour colour;
    double scale;
};
Scaled scaled(const SceneBuilder::Colour& c) {
    const double most = std::max({c[0], c[1], c[2]});
    if (!(most > 1.0)) return {c, 1.0};
    return {{c[0] / most, c[1] / most, c[2] / most}, most};
}

void requireLength(const char* what, std::size_t found, std::size_t expected) {
    if (found == expected) return;
    throw UsageError(std::string(what) + ": expected " + std::to_string(expected) +
                     " numbers, found " + std::to_string(found));
}

Vec3d vec(const SceneBuilder::Point& p) {
    return {p[0], p[1], p[2]};
}

void appendLittle(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
    for (const int shift : {0, 8, 16, 24}) bytes.push_back(std::uint8_t(value >> shift));
}

/// A chunk of a .glb: length, type, content up to a multiple of four bytes.
void appendChunk(std::vector<std::uint8_t>& glb, std::string_view type,
                 std::span<const std::uint8_t> content, std::uint8_t fill) {
    const std::size_t padded = (content.size() + 3) / 4 * 4;
    appendLittle(glb, std::uint32_t(padded));
    glb.insert(glb.end(), type.begin(), type.end());
    glb.insert(glb.end(), content.begin(), content.end());
    glb.insert(glb.end(), padded - content.size(), fill);
}

}  // namespace

struct SceneBuilder::Content {
    json root{{"asset", {{"version", "2.0"}, {"generator", "Lacuna"}}},
              {"scene", 0},
              {"scenes", json::array({{{"nodes", json::array()}}})}};
    std::vector<std::uint8_t> binary;

    json& list(const char* name) {
        json& array = root[name];
        if (array.is_null()) array = json::array();
        return array;
    }
    Index append(const char* name, json entry) {
        json& array = list(name);
        array.push_back(std::move(entry));
        return Index(array.size() - 1);
    }
    void require(const char* name, Index index, const char* what) const {
        const auto array = root.find(name);
        const std::size_t count = array == root.end() ? 0 : array->size();
        if (index >= count) {
            throw UsageError(std::string(what) + ": expected an index below " +
                             std::to_string(count) + ", found " + std::to_string(index));
        }
    }
    void useExtension(json& object, const char* name, json value) {
        object["extensions"][name] = std::move(value);
        json& used = list("extensionsUsed");
        if (std::ranges::find(used, name) == used.end()) used.push_back(name);
    }

    Index view(const void* data, std::size_t size, int target) {
        binary.resize((binary.size() + 3) / 4 * 4);
        json entry{{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}};
        if (target) entry["target"] = target;
        const auto* bytes = static_cast<const std::uint8_t*>(data);
        binary.insert(binary.end(), bytes, bytes + size);
        return append("bufferViews", std::move(entry));
    }
    template <class T>
    Index accessor(std::span<const T> values, int components) {
        constexpr bool kIsIndex = std::is_same_v<T, std::uint32_t>;
        constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
        json entry{{"bufferView",
                    view(values.data(), values.size_bytes(), kIsIndex ? kIndices : kVertices)},
                   {"componentType", kIsIndex ? kUnsignedInt : kFloat},
                   {"count", values.size() / std::size_t(components)},
                   {"type", kTypes[components - 1]}};
        return append("accessors", std::move(entry));
    }
    /// Sets the bounding box of positions, which glTF requires.
    void setBounds(Index positions, std::span<const float> values) {
        std::array<float, 3> low, high;
        std::copy_n(values.begin(), 3, low.begin());
        high = low;
        for (std::size_t i = 0; i < values.size(); ++i) {
            low[i % 3] = std::min(low[i % 3], values[i]);
            high[i % 3] = std::max(high[i % 3], values[i]);
        }
        root["accessors"][positions]["min"] = low;
        root["accessors"][positions]["max"] = high;
    }

    void place(json node, const Transform& toWorld) {
        if (toWorld != kIdentity) node["matrix"] = toWorld;
        const Index index = append("nodes", std::move(node));
        root["scenes"][0]["nodes"].push_back(index);
    }
};

SceneBuilder::SceneBuilder() : content_(std::make_unique<Content>()) {}
SceneBuilder::~SceneBuilder() = default;
SceneBuilder::SceneBuilder(SceneBuilder&&) noexcept = default;
SceneBuilder& SceneBuilder::operator=(SceneBuilder&&) noexcept = default;

SceneBuilder::Transform SceneBuilder::lookAt(const Point& eye, const Point& target,
                                             const Point& up) {
    const Vec3d back = normalize(vec(eye) - vec(target));
    const Vec3d right = normalize(cross(vec(up), back));
    const Vec3d above = cross(back, right);
    if (!(lengthSquared(right) > 0.5) || !(lengthSquared(back) > 0.5) || !isFinite(above)) {
        throw UsageError(
            "lookAt: expected a target off the eye, and an up that is not along the "
            "view, found none; choose another up");
    }
    return {right.x, right.y, right.z, 0, above.x, above.y, above.z, 0,
            back.x,  back.y,  back.z,  0, eye[0],  eye[1],  eye[2],  1};
}

SceneBuilder::Index SceneBuilder::addTexture(int width, int height,
                                             std::span<const std::uint8_t> rgba) {
    if (width < 1 || height < 1) {
        throw UsageError("addTexture: expected a size of at least 1 x 1, found " +
                         std::to_string(width) + " x " + std::to_string(height));
    }
    requireLength("addTexture", rgba.size(), 4 * std::size_t(width) * std::size_t(height));
    std::vector<std::uint8_t> png;
    const auto append = [](void* to, void* data, int size) {
        const auto* bytes = static_cast<const std::uint8_t*>(data);
        auto& all = *static_cast<std::vector<std::uint8_t>*>(to);
        all.insert(all.end(), bytes, bytes + size);
    };
    stbi_write_png_to_func(append, &png, width, height, 4, rgba.data(), 4 * width);
    const Index view = content_->view(png.data(), png.size(), 0);
    const Index image =
        content_->append("images", {{"bufferView", view}, {"mimeType", "image/png"}});
    return content_->append("textures", {{"source", image}});
}

SceneBuilder::Index SceneBuilder::addMaterial(const Material& m) {
    const auto use = [&](const std::optional<Index>& texture) {
        content_->require("textures", *texture, "addMaterial: texture");
        return json{{"index", *texture}};
    };
    const Colour& base = m.baseColour;
    json pbr{{"baseColorFactor", {base[0], base[1], base[2], m.alpha}},
             {"metallicFactor", m.metallic},
             {"roughnessFactor", m.roughness}};
    if (m.baseColourTexture) pbr["baseColorTexture"] = use(m.baseColourTexture);
    if (m.metallicRoughnessTexture) {
        pbr["metallicRoughnessTexture"] = use(m.metallicRoughnessTexture);
    }
    const Scaled emission = scaled(m.emission);
    json material{{"name", m.name},
                  {"pbrMetallicRoughness", std::move(pbr)},
                  {"emissiveFactor", emission.colour},
                  {"doubleSided", m.doubleSided}};
    if (m.emissionTexture) material["emissiveTexture"] = use(m.emissionTexture);
    if (m.normalTexture) {
        material["normalTexture"] = use(m.normalTexture);
        material["normalTexture"]["scale"] = m.normalScale;
    }
    if (m.alphaMode == Material::Alpha::Mask) {
        material["alphaMode"] = "MASK";
        material["alphaCutoff"] = m.alphaCutoff;
    } else if (m.alphaMode == Material::Alpha::Blend) {
        material["alphaMode"] = "BLEND";
    }
    const auto extend = [&](const char* name, json value) {
        content_->useExtension(material, name, std::move(value));
    };
    if (emission.scale != 1.0) {
        extend("KHR_materials_emissive_strength", {{"emissiveStrength", emission.scale}});
    }
    if (m.specular != 1.0) extend("KHR_materials_specular", {{"specularFactor", m.specular}});
    if (m.ior != 1.5) extend("KHR_materials_ior", {{"ior", m.ior}});
    if (m.transmission > 0.0 || m.transmissionTexture) {
        json transmission{{"transmissionFactor", m.transmission}};
        if (m.transmissionTexture) transmission["transmissionTexture"] = use(m.transmissionTexture);
        extend("KHR_materials_transmission", std::move(transmission));
    }
    if (m.solid) {
        json volume{{"thicknessFactor", 1.0}};
        if (m.attenuationDistance > 0.0) {
            volume["attenuationDistance"] = m.attenuationDistance;
            volume["attenuationColor"] = m.attenuation;
        }
        extend("KHR_materials_volume", std::move(volume));
    }
    if (m.clearcoat > 0.0) {
        extend("KHR_materials_clearcoat", {{"clearcoatFactor", m.clearcoat},
                                           {"clearcoatRoughnessFactor", m.clearcoatRoughness}});
    }
    if (m.sheen != Colour{0, 0, 0}) {
        extend("KHR_materials_sheen",
               {{"sheenColorFactor", m.sheen}, {"sheenRoughnessFactor", m.sheenRoughness}});
    }
    if (m.anisotropy > 0.0) {
        extend("KHR_materials_anisotropy", {{"anisotropyStrength", m.anisotropy},
                                            {"anisotropyRotation", m.anisotropyRotation}});
    }
    if (m.diffuseTransmission > 0.0) {
        extend("KHR_materials_diffuse_transmission",
               {{"diffuseTransmissionFactor", m.diffuseTransmission},
                {"diffuseTransmissionColorFactor", m.diffuseTransmissionColour}});
    }
    return content_->append("materials", std::move(material));
}

SceneBuilder::Index SceneBuilder::addMesh(const Mesh& mesh) {
    if (mesh.positions.empty() || mesh.positions.size() % 3 != 0) {
        throw UsageError("addMesh: positions: expected three numbers for each vertex, found " +
                         std::to_string(mesh.positions.size()));
    }
    const std::size_t vertices = mesh.positions.size() / 3;
    if (mesh.triangles.empty() || mesh.triangles.size() % 3 != 0) {
        throw UsageError("addMesh: triangles: expected three indices for each, found " +
                         std::to_string(mesh.triangles.size()));
    }
    const auto largest = std::ranges::max(mesh.triangles);
    if (largest >= vertices) {
        throw UsageError("addMesh: triangles: expected indices below " + std::to_string(vertices) +
                         ", found " + std::to_string(largest));
    }
    if (mesh.material) content_->require("materials", *mesh.material, "addMesh: material");
    const Index positions = content_->accessor(mesh.positions, 3);
    content_->setBounds(positions, mesh.positions);
    json attributes{{"POSITION", positions}};
    const auto addAttribute = [&](const char* name, const char* what, std::span<const float> values,
                                  int components) {
        if (values.empty()) return;
        requireLength(what, values.size(), vertices * std::size_t(components));
        attributes[name] = content_->accessor(values, components);
    };
    addAttribute("NORMAL", "addMesh: normals", mesh.normals, 3);
    addAttribute("TEXCOORD_0", "addMesh: uvs", mesh.uvs, 2);
    addAttribute("COLOR_0", "addMesh: colours", mesh.colours, 4);
    json primitive{{"attributes", std::move(attributes)},
                   {"indices", content_->accessor(mesh.triangles, 1)}};
    if (mesh.material) primitive["material"] = *mesh.material;
    return content_->append("meshes", {{"primitives", json::array({std::move(primitive)})}});
}

void SceneBuilder::addInstance(Index mesh, const Transform& toWorld) {
    content_->require("meshes", mesh, "addInstance");
    content_->place({{"mesh", mesh}}, toWorld);
}

void SceneBuilder::addCamera(const Camera& camera) {
    json perspective{{"yfov", camera.yfov}, {"znear", 0.01}};
    if (camera.aspect > 0.0) perspective["aspectRatio"] = camera.aspect;
    const Index index = content_->append(
        "cameras", {{"type", "perspective"}, {"name", camera.name}, {"perspective", perspective}});
    content_->place({{"camera", index}, {"name", camera.name}}, camera.toWorld);
}

void SceneBuilder::addLamp(const Lamp& lamp) {
    constexpr const char* kExtension = "KHR_lights_punctual";
    constexpr const char* kTypes[] = {"point", "spot", "directional"};
    const Scaled intensity = scaled(lamp.intensity);
    json entry{{"type", kTypes[int(lamp.kind)]},
               {"color", intensity.colour},
               {"intensity", intensity.scale}};
    if (lamp.kind == Lamp::Kind::Spot) {
        entry["spot"] = {{"innerConeAngle", lamp.innerAngle}, {"outerConeAngle", lamp.outerAngle}};
    }
    json& root = content_->root;
    json& lights = root["extensions"][kExtension]["lights"];
    if (lights.is_null()) lights = json::array();
    lights.push_back(std::move(entry));
    json node;
    content_->useExtension(node, kExtension, {{"light", lights.size() - 1}});
    content_->place(std::move(node), lamp.toWorld);
}

std::vector<std::uint8_t> SceneBuilder::glb() const {
    json root = content_->root;
    if (!content_->binary.empty()) {
        root["buffers"] = json::array({{{"byteLength", content_->binary.size()}}});
    }
    const std::string text = root.dump(-1, ' ', false, json::error_handler_t::replace);
    std::vector<std::uint8_t> glb{'g', 'l', 'T', 'F'};
    appendLittle(glb, 2);
    appendLittle(glb, 0);  // placeholder for the length
    appendChunk(glb, "JSON", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()},
                ' ');
    if (!content_->binary.empty()) {
        appendChunk(glb, std::string_view("BIN\0", 4), content_->binary, 0);
    }
    const auto size = std::uint32_t(glb.size());
    for (int i = 0; i < 4; ++i) glb[8 + std::size_t(i)] = std::uint8_t(size >> (8 * i));
    return glb;
}

void SceneBuilder::save(const std::string& path) const {
    const std::vector<std::uint8_t> bytes = glb();
    writeFileAtomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace lacuna
