// Primitives as triangles: modes, normals, flat triangles, what is refused.
#include <limits>

#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Five vertices, no three on a line.
TriangleBuilder fivePoints(int mode) {
    TriangleBuilder b;
    b.primitive()["attributes"]["POSITION"] =
        b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 1, 1, 1, 2, 3}, "VEC3");
    b.primitive()["mode"] = mode;
    return b;
}

TEST(Mesh, TrianglesWithoutIndices) {
    const SceneDescription scene = TriangleBuilder().load();
    expectValid(scene);
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].triangles, (Triangles{{0, 1, 2}}));
    EXPECT_TRUE(scene.meshes[0].normals.empty());
    EXPECT_TRUE(scene.meshes[0].uvs.empty());
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Mesh, StripsAlternateTheirWinding) {
    EXPECT_EQ(fivePoints(5).load().meshes[0].triangles,
              (Triangles{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
}

TEST(Mesh, FansTurnAboutTheFirstVertex) {
    EXPECT_EQ(fivePoints(6).load().meshes[0].triangles,
              (Triangles{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
}

TEST(Mesh, IndexedStrip) {
    TriangleBuilder b = fivePoints(5);
    b.primitive()["indices"] = b.accessor<std::uint16_t>({4, 3, 2, 1, 0}, "SCALAR");
    EXPECT_EQ(b.load().meshes[0].triangles, (Triangles{{4, 3, 2}, {3, 1, 2}, {2, 1, 0}}));
}

TEST(Mesh, PointsAndLinesAreSkippedWithOneWarning) {
    TriangleBuilder b = fivePoints(0);
    for (const int mode : {1, 2, 3, 4}) {
        json primitive = b.primitive();
        primitive["mode"] = mode;
        b.root["meshes"][0]["primitives"].push_back(primitive);
    }
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(warningsWith(scene, "points and lines are not rendered (4 times"), 1);
}

TEST(Mesh, LeftOverVerticesAreReported) {
    const SceneDescription scene = fivePoints(4).load();
    EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
    EXPECT_EQ(warningsWith(scene, "do not complete a triangle"), 1);
    EXPECT_EQ(warningsWith(fivePoints(5).load(), "do not complete a triangle"), 0);
    for (const int mode : {5, 6}) {
        TriangleBuilder b;
        b.primitive()["mode"] = mode;
        b.root["accessors"][0]["count"] = 2;
        EXPECT_EQ(warningsWith(b.load(), "do not complete a triangle"), 1);
        EXPECT_TRUE(b.load().meshes.empty());
    }
}

TEST(Mesh, FlatTrianglesAreCountedInOneWarning) {
    TriangleBuilder b = fivePoints(4);
    // A good triangle, three that have a corner twice, and one with its corners on a line.
    b.root["accessors"][1]["count"] = 5;
    const int line = b.accessor<float>({0, 0, 0, 1, 1, 1, 3, 3, 3}, "VEC3");
    b.primitive()["indices"] =
        b.accessor<std::uint8_t>({0, 1, 2, 0, 1, 1, 3, 3, 4, 4, 2, 4}, "SCALAR");
    b.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", line}}}});
    const SceneDescription scene = b.load();
    expectValid(scene);
    ASSERT_EQ(scene.meshes.size(), 1u);  // of the second primitive nothing is left
    EXPECT_EQ(scene.meshes[0].triangles, (Triangles{{0, 1, 2}}));
    EXPECT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(warningsWith(scene, "triangles without area are dropped (4 times"), 1);
}

TEST(Mesh, TinyTrianglesAreKept) {
    for (const float s : {1e-9f, 1e-19f}) {  // a float cannot hold the second one's squared area
        TriangleBuilder b;
        b.primitive()["attributes"]["POSITION"] =
            b.accessor<float>({s, 0, 0, 2 * s, 0, 0, s, s, 0}, "VEC3");
        EXPECT_EQ(b.load().meshes.size(), 1u) << s;
    }
}

TEST(Mesh, CornersOnALineAreFlatHoweverTheyRound) {
    // Products of these fill twice the digits of a float.
    const float x = 3355443.0f / 4194304.0f, y = 2097151.0f / 4194304.0f;
    TriangleBuilder b;
    b.primitive()["attributes"]["POSITION"] =
        b.accessor<float>({0, 0, 0, x, y, x, 3 * x, 3 * y, 3 * x}, "VEC3");
    EXPECT_TRUE(b.load().meshes.empty());
}

TEST(Mesh, NormalsAndUvs) {
    TriangleBuilder b;
    b.primitive()["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 2, 0, 1, 0, 1, 0, 0}, "VEC3");
    b.primitive()["attributes"]["TEXCOORD_0"] = b.accessor<float>({0, 0, 5, 6, -7, 8}, "VEC2");
    b.primitive()["attributes"]["TEXCOORD_1"] = b.accessor<float>({1, 2, 3, 4, 5, 6}, "VEC2");
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.meshes[0].normals, (std::vector<Vec3>{{0, 0, 2}, {0, 1, 0}, {1, 0, 0}}));
    EXPECT_EQ(scene.meshes[0].uvs, (std::vector<Vec2>{{0, 0}, {5, 6}, {-7, 8}}));
    EXPECT_EQ(scene.meshes[0].uvs1, (std::vector<Vec2>{{1, 2}, {3, 4}, {5, 6}}));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Mesh, TangentsAreReadWhereANormalMapUsesThem) {
    const auto load = [](bool normals, bool map) {
        TriangleBuilder b;
        const int texture = b.texture(png(1, 1, ByteVector(4, 128)));
        b.add("materials", map ? json{{"normalTexture", {{"index", texture}}}} : json::object());
        b.primitive()["material"] = 0;
        b.primitive()["attributes"]["TANGENT"] =
            b.accessor<float>({1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, -1}, "VEC4");
        if (normals) {
            b.primitive()["attributes"]["NORMAL"] =
                b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        }
        return b.load().meshes.at(0).tangents;
    };
    const std::vector<std::array<float, 4>> tangents = load(true, true);
    ASSERT_EQ(tangents.size(), 3u);
    EXPECT_EQ(tangents[2], (std::array<float, 4>{0, 0, 1, -1}));
    EXPECT_TRUE(load(false, true).empty());  // without normals they have to be ignored
    EXPECT_TRUE(load(true, false).empty());
}

TEST(Mesh, ZeroNormalsBecomeFaceNormals) {
    TriangleBuilder b;
    b.primitive()["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 0, 0, 1, 0, 0, 0, 0}, "VEC3");
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.meshes[0].normals, (std::vector<Vec3>{{0, 0, 1}, {0, 1, 0}, {0, 0, 1}}));
    EXPECT_EQ(warningsWith(scene, "zero length"), 1);
    EXPECT_EQ(warningsWith(scene, "2 times"), 1);
    // What rounding has left of a normal has no direction either.
    b.primitive()["attributes"]["NORMAL"] =
        b.accessor<float>({1e-13f, 0, 0, 0, 1, 0, 0, -1e-13f, 0}, "VEC3");
    EXPECT_EQ(b.load().meshes[0].normals, (std::vector<Vec3>{{0, 0, 1}, {0, 1, 0}, {0, 0, 1}}));
}

TEST(Mesh, ZeroNormalsBetweenFacesBackToBackKeepOneSide) {
    TriangleBuilder b;
    b.primitive()["attributes"]["NORMAL"] = b.accessor<float>(std::vector<float>(9, 0.0f), "VEC3");
    b.primitive()["indices"] = b.accessor<std::uint16_t>({0, 1, 2, 2, 1, 0}, "SCALAR");
    EXPECT_EQ(b.load().meshes[0].normals, std::vector<Vec3>(3, {0, 0, 1}));
}

TEST(Mesh, NormalsBeyondFloatsSquaresAreScaled) {
    TriangleBuilder b;
    b.primitive()["attributes"]["NORMAL"] =
        b.accessor<float>({0, 0, 3e38f, 1e-9f, 0, 0, 0, 1, 0}, "VEC3");
    EXPECT_EQ(b.load().meshes[0].normals, (std::vector<Vec3>{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(Mesh, OnePrimitiveOneMesh) {
    TriangleBuilder b;
    b.add("materials", {{"name", "red"}});
    json second = b.primitive();
    second["material"] = 0;
    b.root["meshes"][0]["primitives"].push_back(second);
    const SceneDescription scene = b.load();
    expectValid(scene);
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.instances.size(), 2u);
    // The first has no material: glTF's default comes after the file's own.
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.meshes[0].material, 1u);
    EXPECT_EQ(scene.meshes[1].material, 0u);
    EXPECT_EQ(scene.materials[1].name, "default");
}

TEST(Mesh, OnlyMeshesOfTheSceneAreRead) {
    TriangleBuilder b;
    b.mesh({{"attributes", {{"POSITION", 0}}}, {"mode", 99}});  // unused, so not checked
    EXPECT_EQ(b.load().meshes.size(), 1u);
    b.rootNode({{"mesh", 1}});
    expectRefused(b, {"meshes[1].primitives[0].mode", "99"});
    b.root["meshes"][1]["primitives"][0]["mode"] = 7;
    expectRefused(b, {"meshes[1].primitives[0].mode", "found 7"});
}

TEST(Mesh, NonFiniteNumbersAreRefused) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity()}) {
        for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0"}) {
            TriangleBuilder b;
            std::vector<float> values = {0, 0, 1, 1, 0, 1, 0, 1, 1};
            const bool isUv = std::string(name) == "TEXCOORD_0";
            if (isUv) values.resize(6);
            values[isUv ? 3 : 5] = bad;
            b.primitive()["attributes"][name] = b.accessor<float>(values, isUv ? "VEC2" : "VEC3");
            expectRefused(b, {name, "finite", "vertex 1"});
        }
    }
}

TEST(Mesh, OfPartsTheVertexInTheFileIsNamed) {
    TriangleBuilder b;
    std::vector<float> positions(30);
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = float(i * i % 7);
    positions[8 * 3] = std::numeric_limits<float>::infinity();
    b.primitive()["attributes"]["POSITION"] = b.accessor<float>(positions, "VEC3");
    b.primitive()["indices"] = b.accessor<std::uint8_t>({8, 2, 3}, "SCALAR");
    expectRefused(b, {"POSITION", "finite", "vertex 8"});
}

TEST(Mesh, IndicesBeyondTheVerticesAreRefused) {
    TriangleBuilder b;
    b.primitive()["indices"] = b.accessor<std::uint32_t>({0, 1, 3}, "SCALAR");
    expectRefused(b, {"meshes[0].primitives[0].indices", "below 3", "found 3"});
    b.primitive()["indices"] = b.accessor<std::uint32_t>({0, 1, 0xFFFFFFFFu}, "SCALAR");
    expectRefused(b, {"found 4294967295"});
    b.primitive()["indices"] = b.accessor<std::uint8_t>({0, 255, 1}, "SCALAR");
    expectRefused(b, {"found 255"});
}

TEST(Mesh, AttributesMustAgree) {
    TriangleBuilder b;
    b.primitive()["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC3");
    expectRefused(b, {"NORMAL", "3 elements", "found 2"});
    b.primitive()["attributes"]["NORMAL"] =
        b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    expectRefused(b, {"NORMAL", "3 elements", "found 4"});
    TriangleBuilder c;
    c.primitive()["attributes"] = {{"NORMAL", 0}};
    expectRefused(c, {"POSITION", "none"});
}

TEST(Mesh, WhatIsNotRenderedIsSaid) {
    TriangleBuilder b;
    b.primitive()["targets"] = json::array({{{"POSITION", 0}}});
    b.root["animations"] = json::array({json::object()});
    b.root["skins"] = json::array({{{"joints", {0}}}});
    b.root["nodes"][0]["skin"] = 0;
    const SceneDescription scene = b.load();
    EXPECT_EQ(warningsWith(scene, "morph"), 1);
    EXPECT_EQ(warningsWith(scene, "animations"), 1);
    EXPECT_EQ(warningsWith(scene, "skins"), 1);
    EXPECT_EQ(scene.warnings.size(), 3u);
}

TEST(Mesh, VertexColours) {
    using Colors = std::vector<std::array<float, 4>>;
    TriangleBuilder b;
    b.primitive()["attributes"]["COLOR_0"] =
        b.accessor<float>({1, 0.5, 0, 0.25, 0, 1, 2, -1, 0}, "VEC3");
    EXPECT_EQ(b.load().meshes[0].colors,
              (Colors{{1, 0.5, 0, 1}, {0.25, 0, 1, 1}, {1, 0, 0, 1}}));  // cut off at 0 and 1
    const int bytes =
        b.accessor<std::uint8_t>({255, 0, 51, 102, 0, 0, 0, 0, 255, 255, 255, 255}, "VEC4");
    b.root["accessors"][std::size_t(bytes)]["normalized"] = true;
    b.primitive()["attributes"]["COLOR_0"] = bytes;
    const SceneDescription scene = b.load();
    EXPECT_TRUE(scene.warnings.empty());
    const Colors exact{{1, 0, 0.2f, 0.4f}, {0, 0, 0, 0}, {1, 1, 1, 1}};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 4; ++c) {
            EXPECT_NEAR(scene.meshes[0].colors[i][c], exact[i][c], 1e-6);
        }
    }
    b.primitive()["attributes"]["COLOR_0"] = b.accessor<float>({1, 1, 1, 1, 1, 1}, "VEC2");
    expectRefused(b, {"VEC4"});
}

TEST(Mesh, TheFirstFaultyPrimitiveIsReportedWhateverTheThreads) {
    TriangleBuilder b;
    const int bad = b.accessor<std::uint8_t>({0, 1, 9}, "SCALAR");
    for (int i = 0; i < 64; ++i) {
        json primitive = b.primitive();
        if (i >= 5) primitive["indices"] = bad;
        b.root["meshes"][0]["primitives"].push_back(primitive);
    }
    for (int i = 0; i < 20; ++i) expectRefused(b, {"primitives[6].indices"});
}

}  // namespace
}  // namespace lacuna::test
