#include "tests/gltf/packed.h"

#include <draco/compression/expert_encode.h>
#include <meshoptimizer.h>
#include <webp/encode.h>

#include <cmath>

namespace lacuna::test {
namespace {

struct Plain {
    const std::uint8_t* bytes;
    std::size_t count, components, size;  // size: of one element
    int componentType;
};

/// The data of accessor `index`, which must be packed tightly.
Plain plainOf(const GltfBuilder& builder, int index) {
    const json& accessor = builder.root["accessors"][std::size_t(index)];
    const json& view = builder.root["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::string type = accessor["type"];
    Plain plain;
    plain.bytes = &builder.binary[view["byteOffset"].get<std::size_t>()];
    plain.count = accessor["count"];
    plain.components = type == "SCALAR" ? 1 : std::size_t(type[3] - '0');
    plain.size = view["byteLength"].get<std::size_t>() / plain.count;
    plain.componentType = accessor["componentType"];
    return plain;
}

std::uint32_t indexAt(const Plain& plain, std::size_t i) {
    std::uint32_t value = 0;
    std::memcpy(&value, plain.bytes + i * plain.size, plain.size);
    return value;
}

draco::DataType dracoType(int componentType) {
    switch (componentType) {
        case 5120:
            return draco::DT_INT8;
        case 5121:
            return draco::DT_UINT8;
        case 5122:
            return draco::DT_INT16;
        case 5123:
            return draco::DT_UINT16;
        case 5125:
            return draco::DT_UINT32;
        default:
            return draco::DT_FLOAT32;
    }
}

draco::GeometryAttribute::Type dracoKind(const std::string& name) {
    if (name == "POSITION") return draco::GeometryAttribute::POSITION;
    if (name == "NORMAL") return draco::GeometryAttribute::NORMAL;
    if (name == "COLOR_0") return draco::GeometryAttribute::COLOR;
    if (name.starts_with("TEXCOORD")) return draco::GeometryAttribute::TEX_COORD;
    return draco::GeometryAttribute::GENERIC;
}

/// The first primitive of `mesh`; the ids of its attributes count from 100, in the JSON's order.
std::unique_ptr<draco::Mesh> dracoMesh(const GltfBuilder& builder, int mesh) {
    const json& primitive = builder.root["meshes"][std::size_t(mesh)]["primitives"][0];
    const Plain indices = plainOf(builder, primitive["indices"]);
    auto result = std::make_unique<draco::Mesh>();
    for (std::size_t i = 0; i < indices.count; i += 3) {
        result->AddFace({draco::PointIndex(indexAt(indices, i)),
                         draco::PointIndex(indexAt(indices, i + 1)),
                         draco::PointIndex(indexAt(indices, i + 2))});
    }
    std::uint32_t id = 0;
    for (const auto& [name, accessor] : primitive["attributes"].items()) {
        const Plain plain = plainOf(builder, accessor);
        result->set_num_points(std::uint32_t(plain.count));
        draco::GeometryAttribute attribute;
        attribute.Init(dracoKind(name), nullptr, std::uint8_t(plain.components),
                       dracoType(plain.componentType), plain.componentType != 5126,
                       std::int64_t(plain.size), 0);
        const int at = result->AddAttribute(attribute, true, std::uint32_t(plain.count));
        result->attribute(at)->set_unique_id(100 + id++);  // not the same as its place
        for (std::size_t i = 0; i < plain.count; ++i) {
            result->attribute(at)->SetAttributeValue(draco::AttributeValueIndex(std::uint32_t(i)),
                                                     plain.bytes + i * plain.size);
        }
    }
    return result;
}

using Corner = std::array<float, 16>;
using CornerTriangle = std::array<Corner, 3>;

/// Positions to a thousandth, so that rounding does not change the order.
std::array<long, 3> keyOf(const Corner& c) {
    return {std::lround(c[0] * 1000), std::lround(c[1] * 1000), std::lround(c[2] * 1000)};
}

/// All triangles of all meshes, each beginning with its least corner, in order.
std::vector<CornerTriangle> trianglesOf(const SceneDescription& scene) {
    std::vector<CornerTriangle> triangles;
    for (const Mesh& mesh : scene.meshes) {
        for (const auto& t : mesh.triangles) {
            CornerTriangle triangle{};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t v = t[k];
                float* to = triangle[k].data();
                const auto put = [&](const auto&... values) { ((*to++ = values), ...); };
                const auto has = [&](const auto& list) { return !list.empty(); };
                const Vec3 p = mesh.positions[v];
                const Vec3 n = has(mesh.normals) ? mesh.normals[v] : Vec3{};
                const Vec2 uv = has(mesh.uvs) ? mesh.uvs[v] : Vec2{};
                const Vec2 uv1 = has(mesh.uvs1) ? mesh.uvs1[v] : Vec2{};
                put(p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y, uv1.x, uv1.y);
                if (has(mesh.colors)) {
                    for (const float c : mesh.colors[v]) put(c);
                }
            }
            const auto least = std::min_element(
                triangle.begin(), triangle.end(),
                [](const Corner& a, const Corner& b) { return keyOf(a) < keyOf(b); });
            std::rotate(triangle.begin(), least, triangle.end());
            triangles.push_back(triangle);
        }
    }
    std::sort(triangles.begin(), triangles.end(),
              [](const CornerTriangle& a, const CornerTriangle& b) {
                  return std::array{keyOf(a[0]), keyOf(a[1]), keyOf(a[2])} <
                         std::array{keyOf(b[0]), keyOf(b[1]), keyOf(b[2])};
              });
    return triangles;
}

}  // namespace

ByteVector webp(int width, int height, const ByteVector& rgba) {
    std::uint8_t* coded = nullptr;
    const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &coded);
    ByteVector bytes(coded, coded + size);
    WebPFree(coded);
    return bytes;
}

ByteVector dracoStream(const GltfBuilder& builder, int mesh, DracoCoding coding) {
    const auto plain = dracoMesh(builder, mesh);
    if (coding.metadata) {
        auto metadata = std::make_unique<draco::GeometryMetadata>();
        metadata->AddEntryString("name", "grid");
        auto part = std::make_unique<draco::Metadata>();
        part->AddEntryInt("number", 3);
        metadata->AddSubMetadata("part", std::move(part));
        plain->AddMetadata(std::move(metadata));
    }
    draco::ExpertEncoder encoder(*plain);
    encoder.SetEncodingMethod(coding.edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                                 : draco::MESH_SEQUENTIAL_ENCODING);
    if (coding.positionBits > 0) {
        encoder.SetAttributeQuantization(
            plain->GetNamedAttributeId(draco::GeometryAttribute::POSITION), coding.positionBits);
    }
    if (coding.smallest) {
        encoder.SetSpeedOptions(0, 0);
        encoder.SetAttributeQuantization(
            plain->GetNamedAttributeId(draco::GeometryAttribute::TEX_COORD), 12);
    }
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
    return ByteVector(buffer.data(), buffer.data() + buffer.size());
}

int packByDraco(GltfBuilder& builder, int mesh, DracoCoding coding) {
    const int view = builder.view(dracoStream(builder, mesh, coding));
    json& primitive = builder.root["meshes"][std::size_t(mesh)]["primitives"][0];
    json ids;
    int id = 100;
    for (const auto& [name, accessor] : primitive["attributes"].items()) {
        builder.root["accessors"][accessor.get<std::size_t>()].erase("bufferView");
        ids[name] = id++;
    }
    builder.root["accessors"][primitive["indices"].get<std::size_t>()].erase("bufferView");
    primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view},
                                                             {"attributes", ids}};
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
        builder.root[list].push_back("KHR_draco_mesh_compression");
    }
    return view;
}

int meshoptView(GltfBuilder& builder, const ByteVector& plain, std::size_t count,
                std::size_t stride, const char* mode, const char* filter) {
    ByteVector coded;
    if (mode == std::string("ATTRIBUTES")) {
        coded.resize(meshopt_encodeVertexBufferBound(count, stride));
        coded.resize(
            meshopt_encodeVertexBuffer(coded.data(), coded.size(), plain.data(), count, stride));
    } else {
        std::vector<unsigned> indices(count);
        for (std::size_t i = 0; i < count; ++i) {
            std::memcpy(&indices[i], &plain[i * stride], stride);
        }
        // What is needed for indices of 16 bits is enough for either.
        coded.resize(meshopt_encodeIndexBufferBound(count, 1u << 16) +
                     meshopt_encodeIndexSequenceBound(count, 1u << 16));
        coded.resize(
            mode == std::string("TRIANGLES")
                ? meshopt_encodeIndexBuffer(coded.data(), coded.size(), indices.data(), count)
                : meshopt_encodeIndexSequence(coded.data(), coded.size(), indices.data(), count));
    }
    const int view = builder.view(coded);
    json& element = builder.root["bufferViews"][std::size_t(view)];
    json extension = element;
    extension["byteStride"] = stride;
    extension["count"] = count;
    extension["mode"] = mode;
    if (filter != std::string("NONE")) extension["filter"] = filter;
    element = {{"buffer", 1}, {"byteLength", count * stride}};
    if (mode == std::string("ATTRIBUTES")) element["byteStride"] = stride;
    element["extensions"]["EXT_meshopt_compression"] = extension;
    return view;
}

void packByMeshopt(GltfBuilder& builder, int accessor) {
    const Plain plain = plainOf(builder, accessor);
    const bool isIndices = plain.components == 1 && plain.size >= 2 && plain.size <= 4;
    const std::size_t stride = isIndices ? plain.size : (plain.size + 3) / 4 * 4;
    ByteVector padded(plain.count * stride);
    for (std::size_t i = 0; i < plain.count; ++i) {
        std::memcpy(&padded[i * stride], plain.bytes + i * plain.size, plain.size);
    }
    const char* mode = !isIndices ? "ATTRIBUTES" : plain.count % 3 == 0 ? "TRIANGLES" : "INDICES";
    builder.root["accessors"][std::size_t(accessor)]["bufferView"] =
        meshoptView(builder, padded, plain.count, stride, mode);
}

void declareFallback(GltfBuilder& builder) {
    builder.root["buffers"] = {
        {{"byteLength", builder.binary.size()}},
        {{"byteLength", 1 << 20},
         {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
        builder.root[list].push_back("EXT_meshopt_compression");
    }
}

GridBuilder::GridBuilder(int side, bool allFloats) {
    std::vector<float> positions, normals, uvs, colors;
    std::vector<std::uint16_t> corners;
    for (int y = 0; y <= side; ++y) {
        for (int x = 0; x <= side; ++x) {
            const float u = float(x) / float(side), v = float(y) / float(side);
            positions.insert(positions.end(), {u, v, 0.25f * u * u});
            const float l = std::sqrt(1.0f + 0.25f * u * u);
            normals.insert(normals.end(), {-0.5f * u / l, 0.0f, 1.0f / l});
            uvs.insert(uvs.end(), {u, 1.0f - v});
            colors.insert(colors.end(), {u, v, 0.5f, 1.0f});
            if (x == side || y == side) continue;
            const auto at = [&](int i, int j) {
                return std::uint16_t((y + j) * (side + 1) + x + i);
            };
            corners.insert(corners.end(), {at(0, 0), at(1, 0), at(0, 1)});
            corners.insert(corners.end(), {at(1, 0), at(1, 1), at(0, 1)});
        }
    }
    const auto integers = [](const std::vector<float>& values, auto most) {
        std::vector<decltype(most)> result;
        for (const float v : values) {
            result.push_back(decltype(most)(std::lround(v * float(most))));
        }
        return result;
    };
    json attributes = {{"POSITION", accessor(positions, "VEC3")}};
    if (allFloats) {
        attributes["NORMAL"] = accessor(normals, "VEC3");
        attributes["TEXCOORD_0"] = accessor(uvs, "VEC2");
        attributes["COLOR_0"] = accessor(colors, "VEC4");
    } else {
        attributes["NORMAL"] = accessor(integers(normals, std::int8_t(127)), "VEC3", true);
        attributes["TEXCOORD_0"] = accessor(integers(uvs, std::uint16_t(65535)), "VEC2", true);
        attributes["TEXCOORD_1"] = accessor(integers(uvs, std::uint8_t(255)), "VEC2", true);
        attributes["COLOR_0"] = accessor(integers(colors, std::uint8_t(255)), "VEC4", true);
    }
    mesh({{"attributes", attributes}, {"indices", accessor(corners, "SCALAR")}});
    rootNode({{"mesh", 0}});
}

void expectSameTriangles(const SceneDescription& a, const SceneDescription& b, float tolerance) {
    const auto first = trianglesOf(a), second = trianglesOf(b);
    ASSERT_EQ(first.size(), second.size());
    float worst = 0.0f;
    for (std::size_t i = 0; i < first.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t c = 0; c < first[i][k].size(); ++c) {
                worst = std::max(worst, std::abs(first[i][k][c] - second[i][k][c]));
            }
        }
    }
    EXPECT_LE(worst, tolerance);
}

}  // namespace lacuna::test
