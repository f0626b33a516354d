// The parts of the builder that need no template: compiled once, not in every test.
#include "tests/gltf/gltf_builder.h"

#include <stb/stb_image_write.h>

namespace lacuna::test {

namespace {

void append(ByteVector& to, const void* data, std::size_t size) {
    const std::size_t at = to.size();
    to.resize(at + size);
    if (size > 0) std::memcpy(&to[at], data, size);
}

}  // namespace

std::string base64(const ByteVector& bytes) {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto at = [&](std::size_t k) { return k < bytes.size() ? unsigned(bytes[k]) : 0u; };
        const unsigned bits = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
        for (int k = 0; k < 4; ++k) {
            text += i + std::size_t(k) > bytes.size() ? '=' : digits[(bits >> (18 - 6 * k)) & 63u];
        }
    }
    return text;
}

ByteVector png(int width, int height, const ByteVector& rgba) {
    ByteVector bytes;
    stbi_write_png_to_func(
        [](void* context, void* data, int size) {
            append(*static_cast<ByteVector*>(context), data, std::size_t(size));
        },
        &bytes, width, height, 4, rgba.data(), width * 4);
    return bytes;
}

int GltfBuilder::view(const ByteVector& bytes, int stride) {
    binary.resize((binary.size() + 3) / 4 * 4);
    json element = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}};
    if (stride) element["byteStride"] = stride;
    append(binary, bytes.data(), bytes.size());
    return add("bufferViews", element);
}

int GltfBuilder::accessor(const ByteVector& bytes, int type, std::size_t values,
                          const std::string& shape, bool normalized) {
    const std::size_t components = shape == "SCALAR" ? 1 : std::size_t(shape[3] - '0');
    json element = {{"bufferView", view(bytes)},
                    {"componentType", type},
                    {"count", values / components},
                    {"type", shape}};
    if (normalized) element["normalized"] = true;
    return add("accessors", element);
}

int GltfBuilder::mesh(json primitive) {
    return add("meshes", {{"primitives", json::array({std::move(primitive)})}});
}

int GltfBuilder::rootNode(json node) {
    const int index = add("nodes", std::move(node));
    if (!root.contains("scenes")) root["scenes"] = json::array({json::object()});
    root["scenes"][0]["nodes"].push_back(index);
    return index;
}

int GltfBuilder::texture(const ByteVector& image, json sampler) {
    const int index = add("images", {{"bufferView", view(image)}, {"mimeType", "image/png"}});
    json element = {{"source", index}};
    if (!sampler.is_null()) element["sampler"] = add("samplers", std::move(sampler));
    return add("textures", element);
}

json& GltfBuilder::extras() {
    if (!root.contains("scenes")) root["scenes"] = json::array({json::object()});
    return root["scenes"][0]["extras"];
}

ByteVector GltfBuilder::pack(const std::string& text, const ByteVector& binary) {
    std::string aligned = text;
    aligned.resize((text.size() + 3) / 4 * 4, ' ');
    const std::size_t padded = (binary.size() + 3) / 4 * 4;
    const auto total = std::uint32_t(20 + aligned.size() + (padded ? 8 + padded : 0));
    const std::uint32_t header[] = {0x46546C67, 2, total, std::uint32_t(aligned.size()),
                                    0x4E4F534A};
    ByteVector out;
    append(out, header, sizeof header);
    append(out, aligned.data(), aligned.size());
    if (padded) {
        const std::uint32_t chunk[] = {std::uint32_t(padded), 0x004E4942};
        append(out, chunk, sizeof chunk);
        append(out, binary.data(), binary.size());
        out.resize(total);
    }
    return out;
}

json GltfBuilder::document() const {
    json complete = root;
    if (!binary.empty() && !complete.contains("buffers")) {
        complete["buffers"] = json::array({{{"byteLength", binary.size()}}});
    }
    return complete;
}

ByteVector GltfBuilder::glb() const {
    return pack(document().dump(), binary);
}

SceneDescription GltfBuilder::load(LampUnits units) const {
    const TempDir dir;
    return loadGltf(dir.write("scene.glb", glb()), units);
}

int warningsWith(const SceneDescription& scene, const std::string& text) {
    int count = 0;
    for (const std::string& warning : scene.warnings) {
        EXPECT_EQ(warning.find('\n'), std::string::npos);
        count += warning.find(text) != std::string::npos;
    }
    return count;
}

void expectRefused(const std::string& path, const std::vector<std::string>& parts) {
    try {
        loadGltf(path);
        ADD_FAILURE() << path << " was accepted";
    } catch (const InputError& error) {
        const std::string line = error.what();
        EXPECT_EQ(error.exitCode(), 3);
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        EXPECT_NE(line.find(": "), std::string::npos) << line;
        EXPECT_NE(line.find("expected "), std::string::npos) << line;
        EXPECT_NE(line.find(", found "), std::string::npos) << line;
        EXPECT_NE(line.find("; "), std::string::npos) << line;
        for (const std::string& part : parts) {
            EXPECT_NE(line.find(part), std::string::npos) << "no `" << part << "` in: " << line;
        }
    }
}

void expectRefused(const GltfBuilder& builder, const std::vector<std::string>& parts) {
    const TempDir dir;
    const std::string path = dir.write("scene.glb", builder.glb());
    expectRefused(path, parts);
}

void expectValid(const SceneDescription& scene) {
    ASSERT_FALSE(scene.materials.empty());
    const auto isTexture = [&](TextureUse t) {
        return t.value >= -1 && t.value < std::int32_t(scene.textures.size());
    };
    for (const Material& m : scene.materials) {
        EXPECT_TRUE(isTexture(m.baseColorTexture) && isTexture(m.metallicRoughnessTexture) &&
                    isTexture(m.transmissionTexture) && isTexture(m.emissiveTexture));
        EXPECT_TRUE(isFinite(m.baseColor) && isFinite(m.emission));
        EXPECT_TRUE(m.metallic >= 0 && m.metallic <= 1 && m.roughness >= 0 && m.roughness <= 1);
        EXPECT_TRUE(m.ior >= 1 && m.ior <= 1000 && m.transmission >= 0 && m.transmission <= 1);
    }
    for (const Texture& t : scene.textures) {
        EXPECT_GT(t.width, 0);
        EXPECT_GT(t.height, 0);
        EXPECT_EQ(t.rgba.size(), std::size_t(t.width) * std::size_t(t.height) * 4);
    }
    for (const Mesh& mesh : scene.meshes) {
        EXPECT_LT(mesh.material, scene.materials.size());
        EXPECT_FALSE(mesh.triangles.empty());
        EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
        EXPECT_TRUE(mesh.tangents.empty() || (mesh.tangents.size() == mesh.positions.size() &&
                                              mesh.normals.size() == mesh.positions.size()));
        EXPECT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size());
        bool finite = true, inRange = true;
        for (const Vec3& p : mesh.positions) finite = finite && isFinite(p);
        for (const auto& t : mesh.triangles) {
            for (const std::uint32_t v : t) inRange = inRange && v < mesh.positions.size();
        }
        EXPECT_TRUE(finite);
        EXPECT_TRUE(inRange);
    }
    for (const Instance& instance : scene.instances) {
        EXPECT_LT(instance.mesh, scene.meshes.size());
        EXPECT_TRUE(std::isfinite(instance.toWorld.determinant()));
        EXPECT_NE(instance.toWorld.determinant(), 0.0);
    }
    for (const PunctualLight& light : scene.lights) {
        EXPECT_TRUE(isFinite(light.intensity) && isFinite(light.position));
        EXPECT_NEAR(length(light.direction), 1.0, 1e-9);
    }
    for (const CameraDescription& camera : scene.cameras) {
        EXPECT_TRUE(camera.yfov > 0 && camera.yfov < 3.15 && camera.aspectRatio >= 0);
    }
    EXPECT_EQ(scene.contentHash.size(), 32u);
    for (const char* phase : {"parse", "decode", "meshes"}) {
        EXPECT_TRUE(scene.phaseSeconds.contains(phase)) << phase;
    }
}

}  // namespace lacuna::test
