// Every way glTF can store a number, seen through the positions, normals and uvs of a mesh.
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
    expectRefused(build([](json& s) { s["indices"]["componentType"] = 5126; }), {"5121"});
    expectRefused(build([](json& s) { s["indices"]["bufferView"] = 9; }), {"bufferViews"});
    expectRefused(build([](json& s) { s["values"]["bufferView"] = 9; }), {"bufferViews"});
    // Two indices read as one of 32 bits: 2 << 16.
    expectRefused(build([](json& s) {
                      s["count"] = 1;
                      s["indices"]["componentType"] = 5125;
                  }),
                  {"indices below 3", "131072"});
}

TEST(Accessor, WithoutDataItCannotAskForMuch) {
    TriangleBuilder b;
    b.root["accessors"][0].erase("bufferView");
    EXPECT_TRUE(b.load().meshes.empty());  // zeros: triangles without area
    b.root["accessors"][0]["count"] = 3000000000u;
    expectRefused(b, {"triangles in all"});
    b.root["accessors"][0]["count"] = 30000000u;
    expectRefused(b, {"without a buffer view"});
}

}  // namespace
}  // namespace lacuna::test
