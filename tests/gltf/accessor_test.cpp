// Every way glTF can store a number, seen through the positions, normals and uvs of a mesh.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {
namespace {

/// Positions of the one mesh of a file whose POSITION is accessor 0.
std::vector<Vec3> loadPositions(GltfBuilder& builder) {
    builder.rootNode({{"mesh", builder.mesh({{"attributes", {{"POSITION", 0}}}})}});
    const SceneDescription scene = builder.load();
    EXPECT_EQ(scene.meshes.size(), 1u);
    return scene.meshes.empty() ? std::vector<Vec3>{} : scene.meshes[0].positions;
}

template <class T>
class Components : public testing::Test {};
using AllTypes =
    testing::Types<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::uint32_t, float>;
TYPED_TEST_SUITE(Components, AllTypes);

TYPED_TEST(Components, PlainValuesKeepTheirValue) {
    GltfBuilder b;
    b.accessor<TypeParam>({0, 0, 0, 100, 0, 1, 0, 127, 2}, "VEC3");
    EXPECT_EQ(loadPositions(b), (std::vector<Vec3>{{0, 0, 0}, {100, 0, 1}, {0, 127, 2}}));
}

TYPED_TEST(Components, NormalisedIntegersSpanTheUnitInterval) {
    if constexpr (std::is_integral_v<TypeParam>) {
        constexpr TypeParam most = std::numeric_limits<TypeParam>::max();
        constexpr TypeParam least = std::numeric_limits<TypeParam>::min();
        GltfBuilder b;
        b.accessor<TypeParam>({0, 0, 0, most, 0, 0, least, most, TypeParam(most / 2)}, "VEC3",
                              true);
        const std::vector<Vec3> p = loadPositions(b);
        ASSERT_EQ(p.size(), 3u);
        EXPECT_EQ(p[1].x, 1.0f);
        EXPECT_EQ(p[2].x, least < 0 ? -1.0f : 0.0f);  // -128/127 is cut to -1
        EXPECT_NEAR(p[2].z, 0.5f, 0.004f);
    }
}

TYPED_TEST(Components, IndicesOfUnsignedTypesOnly) {
    TriangleBuilder b;
    b.primitive()["indices"] = b.accessor<TypeParam>({2, 1, 0}, "SCALAR");
    if constexpr (std::is_unsigned_v<TypeParam>) {
        const SceneDescription scene = b.load();
        ASSERT_EQ(scene.meshes.size(), 1u);
        EXPECT_EQ(scene.meshes[0].triangles[0], (std::array<std::uint32_t, 3>{2, 1, 0}));
    } else {
        expectRefused(b, {"accessors[1]", "unsigned integers"});
    }
}

TEST(Accessor, InterleavedWithOffsetAndStride) {
    GltfBuilder b;
    // Position (12 bytes), uv as normalised u16 (4 bytes), 4 bytes that nobody reads; 8 in front.
    ByteVector bytes(8 + 3 * 20, 0xCD);
    const float positions[3][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};
    const std::uint16_t uvs[3][2] = {{0, 65535}, {65535, 0}, {13107, 26214}};
    for (std::size_t i = 0; i < 3; ++i) {
        std::memcpy(&bytes[8 + i * 20], positions[i], 12);
        std::memcpy(&bytes[8 + i * 20 + 12], uvs[i], 4);
    }
    const int view = b.view(bytes, 20);
    b.add("accessors", {{"bufferView", view},
                        {"byteOffset", 8},
                        {"componentType", 5126},
                        {"count", 3},
                        {"type", "VEC3"}});
    b.add("accessors", {{"bufferView", view},
                        {"byteOffset", 20},
                        {"componentType", 5123},
                        {"count", 3},
                        {"type", "VEC2"},
                        {"normalized", true}});
    b.rootNode({{"mesh", b.mesh({{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}})}});
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.meshes[0].positions, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}));
    EXPECT_EQ(scene.meshes[0].uvs[0], (Vec2{0, 1}));
    EXPECT_NEAR(scene.meshes[0].uvs[2].x, 0.2f, 1e-6f);
    EXPECT_NEAR(scene.meshes[0].uvs[2].y, 0.4f, 1e-6f);
}

TEST(Accessor, PackedBytesNeedNoAlignment) {
    GltfBuilder b;
    ByteVector bytes(37, 0);
    const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::memcpy(&bytes[1], positions, 36);
    b.add("accessors", {{"bufferView", b.view(bytes)},
                        {"byteOffset", 1},
                        {"componentType", 5126},
                        {"count", 3},
                        {"type", "VEC3"}});
    EXPECT_EQ(loadPositions(b)[1], Vec3(1, 0, 0));
}

json sparse(GltfBuilder& b, const std::vector<std::uint16_t>& indices, const ByteVector& values) {
    return {{"count", indices.size()},
            {"indices", {{"bufferView", b.view(bytesOf(indices))}, {"componentType", 5123}}},
            {"values", {{"bufferView", b.view(values)}}}};
}

TEST(Accessor, SparseOverABase) {
    GltfBuilder b;
    b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5}, "VEC3");
    const json s = sparse(b, {0, 3}, bytesOf<float>({9, 8, 7, 6, 5, 4}));
    b.root["accessors"][0]["sparse"] = s;
    EXPECT_EQ(loadPositions(b), (std::vector<Vec3>{{9, 8, 7}, {1, 0, 0}, {0, 1, 0}, {6, 5, 4}}));
}

TEST(Accessor, SparseWithoutABaseIsOverZeros) {
    GltfBuilder b;
    const json s = sparse(b, {1, 2}, bytesOf<float>({1, 0, 0, 0, 1, 0}));
    b.add("accessors", {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}, {"sparse", s}});
    EXPECT_EQ(loadPositions(b), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(Accessor, SparseNormalisedAndSparseIndices) {
    GltfBuilder b;
    b.accessor<std::int8_t>({0, 0, 0, 127, 0, 0, 0, 127, 0}, "VEC3", true);
    const json s = sparse(b, {2}, bytesOf<std::int8_t>({0, -127, 127}));
    b.root["accessors"][0]["sparse"] = s;
    const int indices = b.accessor<std::uint8_t>({0, 0, 0}, "SCALAR");
    const json t = sparse(b, {1, 2}, bytesOf<std::uint8_t>({1, 2}));
    b.root["accessors"][1]["sparse"] = t;
    b.rootNode({{"mesh", b.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", indices}})}});
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.meshes[0].positions[2], Vec3(0, -1, 1));
    EXPECT_EQ(scene.meshes[0].triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
}

/// An attribute that may be of integers (glTF 2.0, 3.7.2.1, and KHR_mesh_quantization).
struct IntegerAttribute {
    const char* name;
    std::size_t components;
    bool plain;  ///< integers that are not normalised have a use
};
constexpr IntegerAttribute kIntegerAttributes[] = {
    {"POSITION", 3, true},   {"NORMAL", 3, true},   {"TANGENT", 4, false}, {"TEXCOORD_0", 2, true},
    {"TEXCOORD_1", 2, true}, {"COLOR_0", 3, false}, {"COLOR_0", 4, false}};

/// One row per vertex, as many numbers as the attribute has components in the description.
std::vector<std::vector<float>> rowsOf(const Mesh& mesh, const std::string& name) {
    std::vector<std::vector<float>> rows;
    const auto add3 = [&](const Vec3& v) { rows.push_back({v.x, v.y, v.z}); };
    const auto add2 = [&](const Vec2& v) { rows.push_back({v.x, v.y}); };
    const auto add4 = [&](const std::array<float, 4>& v) { rows.emplace_back(v.begin(), v.end()); };
    if (name == "POSITION") std::for_each(mesh.positions.begin(), mesh.positions.end(), add3);
    if (name == "NORMAL") std::for_each(mesh.normals.begin(), mesh.normals.end(), add3);
    if (name == "TANGENT") std::for_each(mesh.tangents.begin(), mesh.tangents.end(), add4);
    if (name == "TEXCOORD_0") std::for_each(mesh.uvs.begin(), mesh.uvs.end(), add2);
    if (name == "TEXCOORD_1") std::for_each(mesh.uvs1.begin(), mesh.uvs1.end(), add2);
    if (name == "COLOR_0") std::for_each(mesh.colors.begin(), mesh.colors.end(), add4);
    return rows;
}

/// Integers of all sizes that the type has, its limits among them; none is zero.
template <class T>
std::vector<T> integers(std::size_t n, std::uint32_t seed) {
    constexpr T most = std::numeric_limits<T>::max(), least = std::numeric_limits<T>::min();
    std::vector<T> values;
    for (std::size_t i = 0; i < n; ++i) {
        seed = seed * 1664525u + 1013904223u;
        values.push_back(i % 7 == 3 ? most : i % 7 == 5 && least < 0 ? least : T(seed >> 16 | 1));
    }
    return values;
}

/// The values of `row` by glTF 2.0, 3.6.2.3, as the description keeps them.
template <class T>
std::vector<float> expectedRow(const IntegerAttribute& a, const T* row, bool normalized) {
    std::vector<float> expected;
    const bool isColor = std::string(a.name) == "COLOR_0";
    for (std::size_t c = 0; c < a.components; ++c) {
        double x = double(row[c]);
        if (normalized) x = std::max(x / double(std::numeric_limits<T>::max()), -1.0);
        expected.push_back(float(isColor ? std::max(x, 0.0) : x));
    }
    if (isColor && a.components == 3) expected.push_back(1.0f);
    return expected;
}

/// Seven vertices, of which the mesh uses all or three. Sparse values overwrite five of them;
/// without a `base` the others are zero. One of the three is not overwritten, but the vertex before
/// it is, which must not matter.
template <class T>
void expectSparseIntegers(const IntegerAttribute& a, bool normalized, bool base, bool parts) {
    SCOPED_TRACE(std::string(a.name) + " of " + std::to_string(a.components) +
                 (normalized ? ", normalised" : ", plain") + (base ? ", over a base" : "") +
                 (parts ? ", parts" : ", all"));
    constexpr std::size_t kVertices = 7;
    const std::vector<std::uint16_t> written = {0, 1, 3, 5, 6};
    const std::size_t n = a.components;
    std::vector<T> values = base ? integers<T>(kVertices * n, 1) : std::vector<T>(kVertices * n);
    const std::vector<T> over = integers<T>(written.size() * n, 2);

    GltfBuilder b;
    const int positions =
        b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 1, 2, 3, 9, 1, 2, 4, 7, 8, 1, 3}, "VEC3");
    const int normals = b.accessor<float>(std::vector<float>(3 * kVertices, 1.0f), "VEC3");
    const int attribute = b.accessor<T>(values, "VEC" + std::to_string(n), normalized);
    json& accessor = b.root["accessors"][std::size_t(attribute)];
    if (!base) accessor.erase("bufferView");
    accessor["sparse"] = sparse(b, written, bytesOf(over));
    json primitive = {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                      {"material", 0}};
    primitive["attributes"][a.name] = attribute;
    const std::vector<std::uint16_t> corners =
        parts ? std::vector<std::uint16_t>{6, 1, 4}
              : std::vector<std::uint16_t>{0, 1, 2, 2, 3, 4, 4, 5, 6};
    primitive["indices"] = b.accessor<std::uint16_t>(corners, "SCALAR");
    const int texture = b.texture(png(1, 1, ByteVector(4, 128)));
    b.add("materials", {{"normalTexture", {{"index", texture}}}});  // tangents have a use
    b.rootNode({{"mesh", b.mesh(primitive)}});

    for (std::size_t i = 0; i < written.size(); ++i) {
        std::copy_n(&over[i * n], n, &values[written[i] * n]);
    }
    const std::vector<std::size_t> used =
        parts ? std::vector<std::size_t>{1, 4, 6} : std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6};
    const SceneDescription scene = b.load();
    ASSERT_EQ(scene.meshes.size(), 1u);
    const std::vector<std::vector<float>> rows = rowsOf(scene.meshes[0], a.name);
    ASSERT_EQ(rows.size(), used.size());
    for (std::size_t i = 0; i < used.size(); ++i) {
        const std::vector<float> expected = expectedRow(a, &values[used[i] * n], normalized);
        ASSERT_EQ(rows[i].size(), expected.size());
        if (std::string(a.name) == "NORMAL" && values[used[i] * n] == 0) continue;  // repaired
        for (std::size_t c = 0; c < expected.size(); ++c) {
            EXPECT_NEAR(rows[i][c], expected[c], 1e-7 * std::abs(expected[c]))
                << "vertex " << used[i] << ", component " << c;
        }
    }
}

TYPED_TEST(Components, SparseIntegersOfEveryAttribute) {
    if constexpr (std::is_integral_v<TypeParam> && sizeof(TypeParam) < 4) {
        for (const IntegerAttribute& a : kIntegerAttributes) {
            for (const bool parts : {false, true}) {
                for (const bool base : {true, false}) {
                    expectSparseIntegers<TypeParam>(a, true, base, parts);
                    if (a.plain) expectSparseIntegers<TypeParam>(a, false, base, parts);
                }
            }
        }
    }
}

TEST(Accessor, SparsePartsBeginWhereTheySay) {
    GltfBuilder b;
    b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    // Two bytes in front of the indices, a vertex in front of the values.
    json s = sparse(b, {1, 2, 0}, bytesOf<float>({7, 7, 7, 2, 3, 4, 5, 6, 8}));
    s["count"] = 2;
    s["indices"]["byteOffset"] = 2;
    s["values"]["byteOffset"] = 12;
    b.root["accessors"][0]["sparse"] = s;
    EXPECT_EQ(loadPositions(b), (std::vector<Vec3>{{5, 6, 8}, {1, 0, 0}, {2, 3, 4}}));
}

/// Parts of interleaved vertices, and indices that lie apart.
TEST(Accessor, StridesHoldForPartsAndForIndices) {
    GltfBuilder b;
    ByteVector bytes(6 * 16, 0xCD);
    for (std::size_t i = 0; i < 6; ++i) {
        const float position[] = {float(i), float(i * i), 1};
        std::memcpy(&bytes[i * 16], position, 12);
    }
    b.add("accessors", {{"bufferView", b.view(bytes, 16)},
                        {"componentType", 5126},
                        {"count", 6},
                        {"type", "VEC3"}});
    const ByteVector indices = {5, 99, 99, 99, 1, 99, 99, 99, 3};
    b.add("accessors", {{"bufferView", b.view(indices, 4)},
                        {"componentType", 5121},
                        {"count", 3},
                        {"type", "SCALAR"}});
    b.rootNode({{"mesh", b.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", 1}})}});
    const Mesh mesh = b.load().meshes.at(0);
    EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{1, 1, 1}, {3, 9, 1}, {5, 25, 1}}));
    EXPECT_EQ(mesh.triangles.at(0), (std::array<std::uint32_t, 3>{2, 0, 1}));
}

TEST(Accessor, PartsOfASharedVertexBufferAreReadAlone) {
    GltfBuilder b;
    std::vector<float> positions;
    for (int i = 0; i < 100; ++i) positions.insert(positions.end(), {float(i), float(i % 7), 0});
    b.accessor<float>(positions, "VEC3");
    const json s = sparse(b, {50, 98}, bytesOf<float>({-1, -2, -3, 4, 5, 6}));
    b.root["accessors"][0]["sparse"] = s;
    const int indices = b.accessor<std::uint16_t>({98, 20, 99}, "SCALAR");
    b.rootNode({{"mesh", b.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", indices}})}});
    const Mesh mesh = b.load().meshes[0];
    ASSERT_EQ(mesh.positions.size(), 3u);
    EXPECT_EQ(mesh.positions[mesh.triangles[0][0]], Vec3(4, 5, 6));
    EXPECT_EQ(mesh.positions[mesh.triangles[0][1]], Vec3(20, 6, 0));
    EXPECT_EQ(mesh.positions[mesh.triangles[0][2]], Vec3(99, 1, 0));
}

TEST(Accessor, RangesAreChecked) {
    struct Case {
        const char* member;
        json value;
    };
    const Case cases[] = {{"count", 4},
                          {"count", 0},
                          {"count", std::uint64_t(1) << 53},
                          {"count", 1537228672809129302u},  // times 12 wraps to 8
                          {"byteOffset", 4},
                          {"byteOffset", 18446744073709551612u},
                          {"byteOffset", 37},
                          {"componentType", 5124},
                          {"componentType", 5130},
                          {"componentType", 5127},
                          {"type", "VEC2"},
                          {"type", "MAT4"},
                          {"type", "VEC5"},
                          {"count", 3.5},
                          {"count", -3},
                          {"count", "3"}};
    for (const Case& c : cases) {
        SCOPED_TRACE(c.member + c.value.dump());
        TriangleBuilder b;
        b.root["accessors"][0][c.member] = c.value;
        expectRefused(b, {"scene.glb"});
    }
}

TEST(Accessor, LastElementNeedsNoFullStride) {
    GltfBuilder b;
    ByteVector bytes(2 * 32 + 12, 0);
    const float one = 1.0f;
    std::memcpy(&bytes[32], &one, 4);
    std::memcpy(&bytes[64 + 4], &one, 4);
    const int view = b.view(bytes, 32);
    b.add("accessors",
          {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    EXPECT_EQ(loadPositions(b), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    b.root["bufferViews"][std::size_t(view)]["byteLength"] = bytes.size() - 1;
    expectRefused(b, {"accessors[0]", "75 bytes"});
}

TEST(Accessor, StrideMustHoldAnElement) {
    TriangleBuilder b;
    b.root["bufferViews"][0]["byteStride"] = 8;
    expectRefused(b, {"stride of at least 12", "found 8"});
}

TEST(Accessor, SparseRangesAreChecked) {
    const auto build = [](const std::function<void(json&)>& edit) {
        TriangleBuilder b;
        json s = sparse(b, {0, 2}, bytesOf<float>({0, 0, 0, 0, 1, 0}));
        edit(s);
        b.root["accessors"][0]["sparse"] = s;
        return b;
    };
    EXPECT_NO_THROW(build([](json&) {}).load());
    expectRefused(build([](json& s) { s["count"] = 0; }), {"sparse.count"});
    expectRefused(build([](json& s) { s["count"] = 4; }), {"sparse.count"});
    expectRefused(build([](json& s) { s["count"] = 3; }), {"sparse.indices"});
    expectRefused(build([](json& s) { s["indices"]["byteOffset"] = 1; }), {"sparse.indices"});
    expectRefused(build([](json& s) { s["indices"]["byteOffset"] = 4294967296u; }),
                  {"sparse.indices.byteOffset"});
    expectRefused(build([](json& s) { s["values"]["byteOffset"] = 4; }), {"sparse.values"});
    for (const int type : {5120, 5122, 5124, 5126}) {
        expectRefused(build([&](json& s) { s["indices"]["componentType"] = type; }), {"5121"});
    }
    expectRefused(build([](json& s) { s["indices"]["bufferView"] = 9; }), {"bufferViews"});
    expectRefused(build([](json& s) { s["values"]["bufferView"] = 9; }), {"bufferViews"});
    // Two indices read as one of 32 bits: 2 << 16.
    expectRefused(build([](json& s) {
                      s["count"] = 1;
                      s["indices"]["componentType"] = 5125;
                  }),
                  {"indices below 3", "131072"});
    // The first vertex that does not exist.
    TriangleBuilder b;
    const json s = sparse(b, {0, 3}, bytesOf<float>({0, 0, 0, 0, 1, 0}));
    b.root["accessors"][0]["sparse"] = s;
    expectRefused(b, {"indices below 3", "found 3"});
}

TEST(Accessor, TypesThatAreNotWhatTheirUseWants) {
    TriangleBuilder b;
    const int indices = b.accessor<std::uint8_t>({0, 1, 2}, "SCALAR", true);
    b.primitive()["indices"] = indices;
    expectRefused(b, {"plain unsigned integers", "normalised"});
    // Four numbers each, but a matrix's columns are aligned.
    TriangleBuilder m;
    const int colors = m.accessor<float>(std::vector<float>(12, 0.5f), "VEC4");
    m.primitive()["attributes"]["COLOR_0"] = colors;
    EXPECT_EQ(m.load().meshes.size(), 1u);
    m.root["accessors"][std::size_t(colors)]["type"] = "MAT2";
    expectRefused(m, {"accessors[1].type", "VEC4"});
}

TEST(Accessor, NothingIsNoAccessor) {
    for (const bool hasView : {false, true}) {
        TriangleBuilder b;
        if (!hasView) b.root["accessors"][0].erase("bufferView");
        b.root["accessors"][0]["count"] = 0;
        expectRefused(b, {"accessors[0].count", "1 to 4294967295", "found 0"});
    }
    TriangleBuilder b;
    b.primitive()["indices"] = b.accessor<std::uint8_t>({0, 1, 2}, "SCALAR");
    b.root["accessors"][1]["count"] = 0;
    expectRefused(b, {"accessors[1].count", "found 0"});
}

TEST(Accessor, WithoutDataItCannotAskForMuch) {
    TriangleBuilder b;
    b.root["accessors"][0].erase("bufferView");
    EXPECT_TRUE(b.load().meshes.empty());  // zeros: triangles without area
    b.root["accessors"][0]["count"] = 3000000000u;
    expectRefused(b, {"triangles in all"});
    b.root["accessors"][0]["count"] = 30000000u;
    expectRefused(b, {"without a buffer view"});
    TriangleBuilder c;
    c.primitive()["indices"] =
        c.add("accessors", {{"componentType", 5121}, {"count", 30000000u}, {"type", "SCALAR"}});
    expectRefused(c, {"accessor[1] invalid bufferView"});
}

/// Sums are bounded, since many primitives may ask for a little each.
TEST(Accessor, ManyThatAskForALittleAskForMuch) {
    TriangleBuilder b;
    b.root["accessors"][0].erase("bufferView");
    b.root["accessors"][0]["count"] = 6000000u;
    const json primitive = b.primitive();
    for (int i = 0; i < 2; ++i) b.root["meshes"][0]["primitives"].push_back(primitive);
    expectRefused(b, {"meshes[0].primitives[2]", "without a buffer view in all"});

    TriangleBuilder c;  // 2^28 triangles out of seven million bytes
    c.primitive()["indices"] = c.accessor<std::uint8_t>(ByteVector(7000000), "SCALAR");
    c.primitive()["mode"] = 5;
    const json strip = c.primitive();
    for (int i = 0; i < 40; ++i) c.root["meshes"][0]["primitives"].push_back(strip);
    expectRefused(c, {"meshes[0].primitives[38]", "triangles in all"});
}

}  // namespace
}  // namespace lacuna::test
