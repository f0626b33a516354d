// KHR_draco_mesh_compression: packed by Draco's own encoder, held against what was packed.
#include "tests/gltf/everything.h"
#include "tests/gltf/packed.h"

namespace lacuna::test {
namespace {

json& extensionOf(GltfBuilder& b) {
    return b.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
}

TEST(Draco, PackedMeshesAreTheSame) {
    for (const bool allFloats : {false, true}) {
        for (const bool edgebreaker : {false, true}) {
            GridBuilder b(8, allFloats);
            const SceneDescription plain = b.load();
            packByDraco(b, 0, {edgebreaker});
            const SceneDescription packed = b.load();
            expectValid(packed);
            EXPECT_TRUE(packed.warnings.empty()) << packed.warnings.front();
            EXPECT_EQ(packed.meshes[0].triangles.size(), 128u);
            EXPECT_EQ(packed.meshes[0].positions.size(), 81u);
            expectSameTriangles(plain, packed, 0.0f);
        }
    }
}

TEST(Draco, QuantisedPositionsAreNear) {
    GridBuilder b(8);
    const SceneDescription plain = b.load();
    packByDraco(b, 0, {true, 12});
    const SceneDescription packed = b.load();
    expectSameTriangles(plain, packed, 1.0f / 4095);
}

TEST(Draco, PredictedTextureCoordinatesAreNear) {
    GridBuilder b(8, true);
    const SceneDescription plain = b.load();
    packByDraco(b, 0, {true, 12, false, true});
    expectSameTriangles(plain, b.load(), 1.0f / 4095);
}

TEST(Draco, AnyFourBytesLoadOrAreRefused) {
    // Any four bytes may be a count: of triangles, symbols or flags. Here they become 2^31 - 1.
    const TempDir dir;
    GridBuilder b(2, true);
    const int view = packByDraco(b, 0, {true, 12, false, true});
    const json& range = b.root["bufferViews"][std::size_t(view)];
    const std::size_t at = range["byteOffset"], size = range["byteLength"];
    for (std::size_t i = at; i + 4 <= at + size; ++i) {
        GridBuilder damaged = b;
        for (const std::size_t k : {0, 1, 2, 3}) damaged.binary[i + k] = k < 3 ? 0xFF : 0x7F;
        loadsOrIsRefused(dir, damaged.glb());
    }
}

TEST(Draco, MetadataIsPassedOver) {
    GridBuilder b(2);
    const SceneDescription plain = b.load();
    packByDraco(b, 0, {true, 0, true});
    expectSameTriangles(plain, b.load(), 0.0f);
}

TEST(Draco, AttributesOutsideTheStreamStay) {
    GridBuilder b(2);
    const SceneDescription plain = b.load();
    const int colors = b.accessorOf("COLOR_0");
    const json view = b.root["accessors"][std::size_t(colors)]["bufferView"];
    packByDraco(b, 0, {false});  // keeps the order, which the colours need
    b.root["accessors"][std::size_t(colors)]["bufferView"] = view;
    extensionOf(b)["attributes"].erase("COLOR_0");
    expectSameTriangles(plain, b.load(), 0.0f);
}

TEST(Draco, StripsAndMeshesWithoutIndicesAreTriangles) {
    GridBuilder b(2);
    const SceneDescription plain = b.load();
    packByDraco(b);
    b.primitive()["mode"] = 5;
    expectSameTriangles(plain, b.load(), 0.0f);
    b.primitive().erase("mode");
    b.primitive().erase("indices");
    expectSameTriangles(plain, b.load(), 0.0f);
    b.primitive()["mode"] = 1;
    expectRefused(b, {"meshes[0].primitives[0].mode", "4 or 5", "1"});
}

TEST(Draco, SharedStreamsAreReadForEach) {
    GridBuilder b(2);
    packByDraco(b);
    json second = b.primitive();
    b.root["meshes"][0]["primitives"].push_back(second);
    const SceneDescription scene = b.load();
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.meshes[0].triangles, scene.meshes[1].triangles);
}

TEST(Draco, CountsMayNotExceedTheAccessors) {
    GridBuilder b(2);
    packByDraco(b);
    const auto count = [&](int accessor) -> json& {
        return b.root["accessors"][std::size_t(accessor)]["count"];
    };
    count(b.accessorOf("POSITION")) = 8;
    expectRefused(b, {"meshes[0].primitives[0]", "8 vertices", "found 9", "without Draco"});
    count(b.accessorOf("POSITION")) = 9;
    count(b.indices()) = 21;
    expectRefused(b, {"meshes[0].primitives[0]", "7 triangles", "found 8 triangles"});

    // Encoders that drop flat triangles leave fewer.
    count(b.indices()) = 27;
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.meshes[0].triangles.size(), 8u);
    EXPECT_EQ(warningsWith(scene, "fewer vertices or triangles"), 1);
}

TEST(Draco, WhatTheAccessorsSayMustFit) {
    GridBuilder b(2);
    packByDraco(b);
    const json intact = b.root;
    const auto accessor = [&](const char* name) -> json& {
        return b.root["accessors"][std::size_t(b.accessorOf(name))];
    };
    accessor("NORMAL")["type"] = "VEC4";
    expectRefused(b, {"attributes.NORMAL", "4 components", "3"});
    b.root = intact;
    accessor("NORMAL")["type"] = "MAT3";
    expectRefused(b, {"accessors", ".type", "MAT3"});
    b.root = intact;
    accessor("TEXCOORD_0")["componentType"] = 5121;
    expectRefused(b, {"attributes.TEXCOORD_0", "component type can hold"});
    b.root = intact;
    accessor("TEXCOORD_0")["componentType"] = 5124;
    expectRefused(b, {"accessors", "componentType", "5124"});
    b.root = intact;
    b.root["accessors"][std::size_t(b.indices())]["componentType"] = 5126;
    expectRefused(b, {"unsigned integers", "5126"});
    b.root = intact;
    extensionOf(b)["attributes"]["NORMAL"] = 7;
    expectRefused(b, {"attributes.NORMAL", "none of id 7"});
    b.root = intact;
    extensionOf(b)["attributes"]["TANGENT"] = 100;
    expectRefused(b, {"attributes.TANGENT", "attribute of the primitive"});
    b.root = intact;
    extensionOf(b)["attributes"].erase("POSITION");
    expectRefused(b, {"POSITION", "none"});
    b.root = intact;
    extensionOf(b).erase("bufferView");
    expectRefused(b, {"KHR_draco_mesh_compression", "a bufferView"});
    b.root = intact;
    extensionOf(b)["bufferView"] = 1000;
    expectRefused(b, {"KHR_draco_mesh_compression.bufferView", "an index below"});
}

TEST(Draco, IndicesMustFitTheirAccessor) {
    GridBuilder b(20);
    packByDraco(b);
    b.root["accessors"][std::size_t(b.indices())]["componentType"] = 5121;
    expectRefused(b, {"vertex indices below 441 that their accessor can hold"});
}

TEST(Draco, OtherStreamsAreRefused) {
    GridBuilder b(2);
    const int view = packByDraco(b);
    const std::size_t at = b.root["bufferViews"][std::size_t(view)]["byteOffset"];
    const auto refuses = [&](std::size_t byte, std::uint8_t value,
                             const std::vector<std::string>& parts) {
        GridBuilder edited = b;
        edited.binary[at + byte] = value;
        expectRefused(edited, parts);
    };
    refuses(0, 'd', {"packed by Draco", "something else"});
    refuses(5, 1, {"version 2.2", "version 1.2"});
    refuses(6, 3, {"version 2.2", "version 2.3"});
    refuses(7, 0, {"packed by Draco", "something else"});  // a point cloud
    refuses(8, 9, {"sequential or edgebreaker", "method 9"});
    b.root["bufferViews"][std::size_t(view)]["byteLength"] = b.binary.size();
    expectRefused(b, {"bufferViews[" + std::to_string(view) + "]", "a range within"});
}

TEST(Draco, BooleansAreRefused) {
    GridBuilder b(2, true);
    const int view = packByDraco(b, 0, {false});
    constexpr std::uint8_t kFloats = 9, kBooleans = 11;
    constexpr std::uint8_t kLast[] = {3, kFloats, 2, 0, 103};  // the last attribute's head
    const std::size_t begin = b.root["bufferViews"][std::size_t(view)]["byteOffset"];
    const auto at = std::search(b.binary.begin() + std::ptrdiff_t(begin), b.binary.end(),
                                std::begin(kLast), std::end(kLast));
    ASSERT_NE(at, b.binary.end());
    at[1] = kBooleans;
    expectRefused(b, {"attributes.TEXCOORD_0", "numbers", "booleans"});
}

/// A stream that claims `faces` triangles and as many vertices, and has none of them.
ByteVector claims(std::uint8_t method, std::uint32_t faces) {
    ByteVector bytes = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, method, 0, 0};
    if (method == 1) bytes.push_back(0);  // the plain traversal
    const auto put = [&](std::uint32_t value) {
        for (; value >= 128; value >>= 7) bytes.push_back(std::uint8_t(value | 128));
        bytes.push_back(std::uint8_t(value));
    };
    put(faces);
    put(faces);
    bytes.push_back(0);
    put(faces);
    put(0);
    return bytes;
}

TEST(Draco, ClaimsAreNotBelieved) {
    for (const std::uint8_t method : {0, 1}) {
        for (const std::uint32_t faces : {1000u, 100'000'000u, 4'000'000'000u}) {
            GridBuilder b(2);
            packByDraco(b);
            extensionOf(b)["bufferView"] = b.view(claims(method, faces));
            expectRefused(b, {"meshes[0].primitives[0]", "8 triangles"});
            b.root["accessors"][std::size_t(b.indices())]["count"] = std::uint64_t(3) * faces;
            b.root["accessors"][std::size_t(b.accessorOf("POSITION"))]["count"] = faces;
            expectRefused(b, {"meshes[0].primitives[0]"});
        }
    }
}

TEST(Draco, MetadataIsNotBelieved) {
    // Each of 100,000 parts of metadata claims all bytes that are left as further parts.
    ByteVector bytes = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0x80, 0, 0, 0xFF, 0xFF, 0x03};
    for (int i = 0; i < 100'000; ++i) {
        bytes.insert(bytes.end(), {1, std::uint8_t(i), 0, 0xFF, 0xFF, 0x03});
    }
    GridBuilder b(2);
    packByDraco(b);
    extensionOf(b)["bufferView"] = b.view(bytes);
    expectRefused(b, {"damaged metadata"});
}

TEST(Draco, DamagedStreamsAreReadOrRefused) {
    const TempDir dir;
    for (const bool edgebreaker : {false, true}) {
        GridBuilder b(2);
        const int view = packByDraco(b, 0, {edgebreaker, 12, true});
        json& range = b.root["bufferViews"][std::size_t(view)];
        const std::size_t at = range["byteOffset"], size = range["byteLength"];
        int refused = 0;
        for (std::size_t i = 0; i < size; ++i) {
            for (const std::uint8_t change : {0x01, 0x80, 0xFF}) {
                GridBuilder damaged = b;
                damaged.binary[at + i] ^= change;
                refused += !loadsOrIsRefused(dir, damaged.glb());
            }
        }
        EXPECT_GT(refused, 60);
        for (std::size_t i = 0; i < size; ++i) {
            range["byteLength"] = i;
            EXPECT_FALSE(loadsOrIsRefused(dir, b.glb())) << i << " of " << size;
        }
    }
}

}  // namespace
}  // namespace lacuna::test
