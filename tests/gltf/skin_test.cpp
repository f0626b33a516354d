// Skins and morph targets at rest.
#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {
namespace {

/// A triangle that two joints lead: the first joint leads the first two corners, and half of the
/// third.
struct SkinBuilder : TriangleBuilder {
    SkinBuilder() {
        primitive()["attributes"]["JOINTS_0"] =
            accessor<std::uint8_t>({0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4");
        primitive()["attributes"]["WEIGHTS_0"] =
            accessor<float>({1, 0, 0, 0, 2, 0, 0, 0, 0.5f, 0.5f, 0, 0}, "VEC4");
        primitive()["attributes"]["NORMAL"] = accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        add("skins", {{"joints", {1, 2}}});
        root["nodes"][0]["skin"] = 0;
        root["nodes"][0]["translation"] = {100, 0, 0};  // which must not move a skinned mesh
        rootNode({{"translation", {0, 0, 2}}});
        rootNode({{"translation", {0, 4, 2}}});
    }
    /// Inverse bind matrices, which move by -x, -y, -z before a joint leads.
    void bind(std::vector<std::array<float, 3>> origins) {
        std::vector<float> matrices;
        for (const auto& [x, y, z] : origins) {
            matrices.insert(matrices.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -y, -z, 1});
        }
        const int index = add("accessors", {{"bufferView", view(bytesOf(matrices))},
                                            {"componentType", 5126},
                                            {"count", origins.size()},
                                            {"type", "MAT4"}});
        root["skins"][0]["inverseBindMatrices"] = index;
    }
};

/// The corners of the one triangle in the world.
std::array<Vec3d, 3> cornersOf(const SceneDescription& scene) {
    std::array<Vec3d, 3> corners;
    EXPECT_EQ(scene.instances.size(), 1u);
    const Instance& instance = scene.instances[0];
    const Mesh& mesh = scene.meshes[instance.mesh];
    EXPECT_EQ(mesh.triangles.size(), 1u);
    for (std::size_t i = 0; i < 3; ++i) {
        corners[i] = instance.toWorld.point(Vec3d(mesh.positions[mesh.triangles[0][i]]));
    }
    return corners;
}

void expectCorners(const SceneDescription& scene, const std::array<Vec3d, 3>& expected) {
    expectValid(scene);
    const auto corners = cornersOf(scene);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(length(corners[i] - expected[i]), 0.0, 1e-6) << i;
    }
}

TEST(Skin, VerticesFollowTheirJoints) {
    SkinBuilder b;
    const SceneDescription scene = b.load();
    expectCorners(scene, {Vec3d{0, 0, 2}, Vec3d{1, 0, 2}, Vec3d{0, 3, 2}});
    EXPECT_EQ(warningsWith(scene, "skins are rendered at rest"), 1);
}

TEST(Skin, AtTheBindPoseTheMeshIsAsItIs) {
    SkinBuilder b;
    b.bind({{0, 0, 2}, {0, 4, 2}});
    const SceneDescription scene = b.load();
    expectCorners(scene, {Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}});
    EXPECT_EQ(scene.meshes[scene.instances[0].mesh].normals[2].z, 1.0f);
}

TEST(Skin, NormalsTurnWithTheJoints) {
    SkinBuilder b;
    for (const int joint : {1, 2}) {
        b.root["nodes"][std::size_t(joint)] = {{"rotation", {1, 0, 0, 1}}};  // z to -y
    }
    const SceneDescription scene = b.load();
    expectCorners(scene, {Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 0, 1}});
    const Instance& instance = scene.instances[0];
    const Vec3d normal = instance.toWorld.normal(Vec3d(scene.meshes[instance.mesh].normals[0]));
    EXPECT_NEAR(length(normal - Vec3d{0, -1, 0}), 0.0, 1e-6);
}

TEST(Skin, MirroredJointsMirrorTheWinding) {
    SkinBuilder b;
    for (const int joint : {1, 2}) b.root["nodes"][std::size_t(joint)] = {{"scale", {-1, 1, 1}}};
    const SceneDescription scene = b.load();
    expectCorners(scene, {Vec3d{0, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 1, 0}});
    EXPECT_LT(scene.instances[0].toWorld.determinant(), 0.0);
}

TEST(Skin, WhatJointsCollapseIsLeftOut) {
    SkinBuilder b;
    for (const int joint : {1, 2}) b.root["nodes"][std::size_t(joint)] = {{"scale", {0, 0, 0}}};
    EXPECT_TRUE(b.load().instances.empty());
}

TEST(Skin, JointsWithoutWeightMayBeAnything) {
    SkinBuilder b;
    b.primitive()["attributes"]["JOINTS_0"] =
        b.accessor<std::uint8_t>({0, 9, 9, 9, 0, 1, 9, 9, 0, 1, 9, 9}, "VEC4");
    b.primitive()["attributes"]["JOINTS_1"] = b.accessor<std::uint8_t>(ByteVector(12), "VEC4");
    const SceneDescription scene = b.load();
    expectCorners(scene, {Vec3d{0, 0, 2}, Vec3d{1, 0, 2}, Vec3d{0, 3, 2}});
    EXPECT_EQ(warningsWith(scene, "joints beyond the first four"), 1);
}

TEST(Skin, WithoutInfluencesTheNodePlacesTheMesh) {
    SkinBuilder b;
    b.primitive()["attributes"].erase("WEIGHTS_0");
    expectCorners(b.load(), {Vec3d{100, 0, 0}, Vec3d{101, 0, 0}, Vec3d{100, 1, 0}});
}

TEST(Skin, SkinsAreChecked) {
    SkinBuilder b;
    const json intact = b.root;
    b.root["skins"][0]["joints"] = {1};
    expectRefused(b, {"nodes[0].skin", "joints below 1", "1 at vertex 2"});
    b.root["skins"][0]["joints"] = {1, 7};
    expectRefused(b, {"skins[0].joints[1]", "an index below 3"});
    b.root["skins"][0]["joints"] = json::array();
    expectRefused(b, {"skins[0].joints", "none"});
    b.root["skins"][0].erase("joints");
    expectRefused(b, {"skins[0].joints", "none"});
    b.root = intact;
    b.root["scenes"][0]["nodes"] = {0, 1};
    expectRefused(b, {"skins[0].joints", "nodes of the scene", "nodes[2]"});
    b.root = intact;
    b.root["skins"][0]["inverseBindMatrices"] = 0;
    expectRefused(b, {"accessors[0].type", "MAT4"});
    b.root = intact;
    b.bind({{0, 0, 0}});
    expectRefused(b, {"skins[0].inverseBindMatrices", "2 matrices", "1"});
    b.root = intact;
    b.bind({{0, 0, 0}, {0, INFINITY, 0}});
    expectRefused(b, {"skins[0].inverseBindMatrices", "of joint 1"});
    b.root = intact;
    b.bind({{0, 0, 0}, {0, -3e38f, 0}});
    b.root["nodes"][2]["scale"] = {1, 1e10, 1};
    expectRefused(b, {"nodes[0].skin", "finite positions"});
}

TEST(Morph, TargetsCountByTheMeshsWeights) {
    TriangleBuilder b;
    const int moves = b.accessor<float>({0, 0, 2, 0, 0, 2, 0, 0, 4}, "VEC3");
    b.primitive()["targets"] = {{{"POSITION", moves}}, {{"POSITION", moves}}};
    expectCorners(b.load(), {Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}});
    b.root["meshes"][0]["weights"] = {0.5, 0};
    const SceneDescription scene = b.load();
    expectCorners(scene, {Vec3d{0, 0, 1}, Vec3d{1, 0, 1}, Vec3d{0, 1, 2}});
    EXPECT_EQ(warningsWith(scene, "morph targets are rendered at rest"), 1);

    b.root["meshes"][0]["weights"] = {1e39, 0};
    expectRefused(b, {"meshes[0].primitives[0].targets", "finite sums"});
    b.root["meshes"][0]["weights"] = {"x"};
    expectRefused(b, {"meshes[0].weights[0]", "a number"});
    b.root["meshes"][0]["weights"] = {1};
    b.root["accessors"][std::size_t(moves)]["count"] = 2;
    expectRefused(b, {"POSITION", "3 elements"});
}

}  // namespace
}  // namespace lacuna::test
