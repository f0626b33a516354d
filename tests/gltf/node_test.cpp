// The hierarchy, and what it places: instances, cameras, lights; scene extras.
#include <cmath>
#include <numbers>

#include "tests/gltf/gltf_builder.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

void expectNear(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

/// A triangle under a node with these members.
TriangleBuilder withNode(const json& members) {
    TriangleBuilder b;
    b.root["nodes"][0].update(members);
    return b;
}

Affine loadTransform(const json& members) {
    const SceneDescription scene = withNode(members).load();
    EXPECT_EQ(scene.instances.size(), 1u);
    return scene.instances.empty() ? Affine{} : scene.instances[0].toWorld;
}

TEST(Node, NoTransformIsTheIdentity) {
    const Affine a = loadTransform(json::object());
    EXPECT_EQ(a.point({1, 2, 3}), Vec3d(1, 2, 3));
}

TEST(Node, GpuInstancesAreCopiesInTheNodesCoordinates) {
    TriangleBuilder b = withNode({{"scale", {2, 2, 2}}});
    // A quarter turn about +Z, as normalised bytes.
    const json attributes = {
        {"TRANSLATION", b.accessor<float>({1, 0, 0, 0, 5, 0, 0, 0, 7}, "VEC3")},
        {"ROTATION",
         b.accessor<std::int8_t>({0, 0, 0, 127, 0, 0, 90, 90, 0, 0, 0, 127}, "VEC4", true)},
        {"SCALE", b.accessor<float>({1, 1, 1, 1, 2, 3, 0, 1, 1}, "VEC3")}};
    b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    b.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const SceneDescription scene = b.load();
    ASSERT_EQ(scene.instances.size(), 2u);  // the third is scaled to nothing
    EXPECT_EQ(warningsWith(scene, "scaled to nothing"), 1);
    EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh);
    expectNear(scene.instances[0].toWorld.point({1, 1, 1}), {4, 2, 2});
    expectNear(scene.instances[1].toWorld.point({0, 1, 1}), {-4, 10, 6});

    b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
        b.accessor<float>({1, 1, 1}, "VEC3");
    expectRefused(b, {"EXT_mesh_gpu_instancing.SCALE", "3 elements"});

    // Millions of copies out of a few bytes.
    b.root["accessors"].push_back({{"componentType", 5126}, {"count", 1 << 24}, {"type", "VEC3"}});
    b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"SCALE", b.root["accessors"].size() - 1}};
    expectRefused(b, {"EXT_mesh_gpu_instancing.SCALE", "buffer view"});
}

TEST(Node, TrsScalesThenRotatesThenTranslates) {
    const double s = std::sqrt(0.5);  // a quarter turn about +Z
    const Affine a = loadTransform(
        {{"translation", {10, 20, 30}}, {"rotation", {0, 0, s, s}}, {"scale", {2, 3, 4}}});
    expectNear(a.point({1, 0, 0}), {10, 22, 30});
    expectNear(a.point({0, 1, 0}), {7, 20, 30});
    expectNear(a.point({0, 0, 1}), {10, 20, 34});
}

TEST(Node, RotationAboutEveryAxis) {
    const double s = std::sqrt(0.5);
    expectNear(loadTransform({{"rotation", {s, 0, 0, s}}}).vector({0, 1, 0}), {0, 0, 1});
    expectNear(loadTransform({{"rotation", {0, s, 0, s}}}).vector({0, 0, 1}), {1, 0, 0});
    expectNear(loadTransform({{"rotation", {0.5, 0.5, 0.5, 0.5}}}).vector({1, 2, 3}), {3, 1, 2});
    // Not quite unit, as exporters round: still a rotation.
    EXPECT_NEAR(loadTransform({{"rotation", {0.1, 0.2, 0.3, 1.5}}}).determinant(), 1.0, 1e-12);
}

TEST(Node, MatricesAreColumnMajor) {
    const Affine a =
        loadTransform({{"matrix", {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 10, 0, 11, 12, 13, 1}}});
    EXPECT_EQ(a.point({0, 0, 0}), Vec3d(11, 12, 13));
    EXPECT_EQ(a.vector({1, 0, 0}), Vec3d(1, 2, 3));
    EXPECT_EQ(a.vector({0, 0, 1}), Vec3d(7, 8, 10));
}

TEST(Node, ParentsMultiplyFromTheLeft) {
    TriangleBuilder b;
    const int child = b.add("nodes", {{"mesh", 0}, {"translation", {1, 0, 0}}});
    const int middle = b.add("nodes", {{"children", {child}}, {"scale", {2, 2, 2}}});
    b.root["nodes"][0] = {{"children", {middle}}, {"translation", {0, 5, 0}}};
    const SceneDescription scene = b.load();
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].toWorld.point({0, 0, 0}), Vec3d(2, 5, 0));
}

TEST(Node, InstancesShareAMesh) {
    TriangleBuilder b;
    for (int i = 1; i < 5; ++i) b.rootNode({{"mesh", 0}, {"translation", {i, 0, 0}}});
    const SceneDescription scene = b.load();
    expectValid(scene);
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(scene.instances[i].toWorld.m[3].x, double(i));
}

TEST(Node, NegativeScaleStaysInTheMatrix) {
    const SceneDescription scene = withNode({{"scale", {-1, 1, 1}}}).load();
    EXPECT_EQ(scene.instances[0].toWorld.determinant(), -1.0);
    EXPECT_EQ(scene.meshes[0].triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
}

TEST(Node, NothingOfZeroScale) {
    const SceneDescription scene = withNode({{"scale", {1, 0, 1}}}).load();
    EXPECT_TRUE(scene.instances.empty());
    EXPECT_EQ(warningsWith(scene, "scaled to nothing"), 1);
}

TEST(Node, BadTransformsAreRefused) {
    expectRefused(withNode({{"scale", {1e200, 1e200, 1e200}}}), {"nodes[0]", "finite transform"});
    expectRefused(withNode({{"rotation", {0, 0, 0, 0}}}), {"nodes[0].rotation", "quaternion"});
    expectRefused(withNode({{"rotation", {0, 0, 1}}}), {"nodes[0].rotation", "4 numbers"});
    expectRefused(withNode({{"translation", "here"}}), {"nodes[0].translation", "3 numbers"});
    expectRefused(withNode({{"matrix", {1, 2, 3}}}), {"nodes[0].matrix", "16 numbers"});
    expectRefused(withNode({{"matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}),
                  {"nodes[0].matrix", "last row"});
}

TEST(Node, CyclesAndSecondParentsAreRefused) {
    TriangleBuilder self;
    self.root["nodes"][0]["children"] = {0};
    expectRefused(self, {"nodes"});

    TriangleBuilder loop;  // of nodes that the scene does not even reach
    loop.add("nodes", {{"children", {2}}});
    loop.add("nodes", {{"children", {1}}});
    expectRefused(loop, {"nodes[1]", "a cycle"});

    TriangleBuilder two;
    two.add("nodes", {{"mesh", 0}});
    two.root["nodes"][0]["children"] = {1};
    two.rootNode({{"children", {1}}});
    expectRefused(two, {"nodes[1]", "one parent"});

    TriangleBuilder twice;
    twice.add("nodes", {{"mesh", 0}});
    twice.root["nodes"][0]["children"] = {1, 1};
    expectRefused(twice, {"nodes[1]", "one parent"});

    TriangleBuilder rootTwice;
    rootTwice.root["scenes"][0]["nodes"] = {0, 0};
    expectRefused(rootTwice, {"scenes[0].nodes", "once"});

    TriangleBuilder rootAndChild;
    rootAndChild.rootNode({{"children", {0}}});
    expectRefused(rootAndChild, {"scenes[0].nodes", "nodes[0]"});
}

TEST(Node, ChainsMayBeLong) {
    TriangleBuilder b;
    constexpr int kLength = 200000;
    json nodes = json::array({{{"children", {1}}}});
    for (int i = 1; i < kLength; ++i) {
        json node = {{"translation", {1, 0, 0}}};
        if (i + 1 < kLength) node["children"] = {i + 1};
        nodes.push_back(std::move(node));
    }
    nodes.back()["mesh"] = 0;
    b.root["nodes"] = nodes;
    const SceneDescription scene = b.load();
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].toWorld.m[3].x, double(kLength - 1));
}

TEST(Node, OnlyTheDefaultScene) {
    TriangleBuilder b;
    b.add("nodes", {{"mesh", 0}, {"translation", {7, 0, 0}}});
    b.root["scenes"].push_back({{"nodes", {1}}, {"extras", {{"lacuna", {{"width", 9}}}}}});
    EXPECT_EQ(b.load().instances[0].toWorld.m[3].x, 0.0);
    EXPECT_FALSE(b.load().width);
    b.root["scene"] = 1;
    const SceneDescription scene = b.load();
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].toWorld.m[3].x, 7.0);
    EXPECT_EQ(scene.width, 9);
}

TEST(Node, WithoutScenesAllRootsAreDrawn) {
    TriangleBuilder b;
    b.root.erase("scenes");
    b.root["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"mesh", 0}}};
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(warningsWith(scene, "no scene"), 1);
}

json perspective(double yfov) {
    return {{"type", "perspective"}, {"perspective", {{"yfov", yfov}, {"znear", 0.1}}}};
}

TEST(Camera, PerspectiveOnesWithNamesAndTransforms) {
    GltfBuilder b;
    json first = perspective(0.5);
    first["name"] = "main";
    first["perspective"]["aspectRatio"] = 2.0;
    b.add("cameras", first);
    b.add("cameras", perspective(1.0));
    b.rootNode({{"camera", 0}, {"translation", {1, 2, 3}}});
    b.rootNode({{"camera", 1}, {"name", "side"}});
    b.rootNode({{"camera", 1}});
    const SceneDescription scene = b.load();
    expectValid(scene);
    ASSERT_EQ(scene.cameras.size(), 3u);
    EXPECT_EQ(scene.cameras[0].name, "main");
    EXPECT_EQ(scene.cameras[0].yfov, 0.5);
    EXPECT_EQ(scene.cameras[0].aspectRatio, 2.0);
    EXPECT_EQ(scene.cameras[0].toWorld.m[3], Vec3d(1, 2, 3));
    EXPECT_EQ(scene.cameras[1].name, "side");
    EXPECT_EQ(scene.cameras[1].aspectRatio, 0.0);
    EXPECT_EQ(scene.cameras[2].name, "camera2");
    EXPECT_NO_THROW(requireCamera(scene));
}

TEST(Camera, OrthographicOnesAreSkipped) {
    GltfBuilder b;
    b.add("cameras", {{"type", "orthographic"},
                      {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 9}, {"znear", 0}}}});
    b.rootNode({{"camera", 0}});
    const SceneDescription scene = b.load();
    EXPECT_TRUE(scene.cameras.empty());
    EXPECT_EQ(warningsWith(scene, "orthographic"), 1);
    try {
        requireCamera(scene);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("camera"), std::string::npos);
    }
    stabilityCase("strange-cameras", double(scene.cameras.size()), "cameras");
}

TEST(Camera, ImpossibleOnesAreRefused) {
    for (const double yfov : {0.0, -1.0, 3.2, 1e300}) {
        GltfBuilder b;
        b.add("cameras", perspective(yfov));
        b.rootNode({{"camera", 0}});
        expectRefused(b, {"cameras[0].perspective.yfov"});
    }
    GltfBuilder b;
    b.add("cameras", perspective(1));
    b.rootNode({{"camera", 0}});
    b.root["cameras"][0]["perspective"]["aspectRatio"] = -1;
    expectRefused(b, {"aspectRatio"});
    b.root["cameras"][0].erase("perspective");
    expectRefused(b, {"scene.glb"});
    b.root["cameras"][0]["type"] = "fisheye";
    expectRefused(b, {"fisheye"});
}

GltfBuilder withLight(const json& light, const json& node = json::object()) {
    GltfBuilder b;
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
    json placed = node;
    placed["extensions"]["KHR_lights_punctual"]["light"] = 0;
    b.rootNode(placed);
    return b;
}

TEST(Light, PointSpotDirectional) {
    const double s = std::sqrt(0.5);
    const json turned = {
        {"rotation", {0, s, 0, s}}, {"translation", {1, 2, 3}}, {"scale", {9, 9, 9}}};
    SceneDescription scene =
        withLight({{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 8}}, turned).load();
    expectValid(scene);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].kind, PunctualLight::Kind::Point);
    EXPECT_EQ(scene.lights[0].intensity, Rgb(8, 4, 2));
    EXPECT_EQ(scene.lights[0].position, Vec3d(1, 2, 3));

    scene = withLight(
                {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.75}}}},
                turned)
                .load();
    EXPECT_EQ(scene.lights[0].kind, PunctualLight::Kind::Spot);
    EXPECT_EQ(scene.lights[0].intensity, Rgb(1.0f));
    EXPECT_EQ(scene.lights[0].innerConeAngle, 0.25);
    EXPECT_EQ(scene.lights[0].outerConeAngle, 0.75);
    expectNear(scene.lights[0].direction, {-1, 0, 0});

    scene = withLight({{"type", "directional"}, {"intensity", 3}}, turned).load();
    EXPECT_EQ(scene.lights[0].kind, PunctualLight::Kind::Directional);
    expectNear(scene.lights[0].direction, {-1, 0, 0});
}

TEST(Light, GroupOfItsNodeElseItsName) {
    const json point = {{"type", "point"}, {"name", "Light.001"}};
    const auto groupUnder = [&](const json& node) {
        const SceneDescription scene = withLight(point, node).load();
        return scene.lights.at(0).group;
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(withLight(point, json::object()).load().lights.at(0).names, Names{"Light.001"});
    EXPECT_EQ(withLight(point, {{"name", "bulb"}}).load().lights.at(0).names,
              (Names{"bulb", "Light.001"}));
    EXPECT_EQ(groupUnder(json::object()), "Light.001");
    EXPECT_EQ(groupUnder({{"name", "bulb"}}), "bulb");
    json node = {{"name", "bulb"}};
    node["extras"]["lacuna"]["light_group"] = "key";
    EXPECT_EQ(groupUnder(node), "key");
    // As Blender writes a property that was typed in.
    node["extras"]["lacuna"] = R"({"light_group": "rim"})";
    EXPECT_EQ(groupUnder(node), "rim");
    node["extras"] = {{"lacuna", json::object()}, {"other", 1}};
    EXPECT_EQ(groupUnder(node), "bulb");
}

TEST(Node, HiddenOnesHaveNeitherMeshNorLightNorHasWhatIsBelow) {
    const auto hidden = [](bool visible) {
        return json{{"KHR_node_visibility", {{"visible", visible}}}};
    };
    TriangleBuilder b;
    b.root["extensionsUsed"] =
        b.root["extensionsRequired"] = {"KHR_node_visibility", "KHR_lights_punctual"};
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    const std::size_t lamp = b.root["nodes"].size();
    b.root["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    const std::size_t below = b.root["nodes"].size();
    b.root["nodes"].push_back({{"mesh", 0}, {"extensions", hidden(true)}});
    b.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
    const std::size_t eye = b.root["nodes"].size();
    b.root["nodes"].push_back({{"camera", 0}, {"translation", {0, 0, 5}}});
    b.rootNode({{"children", {lamp, below, eye}}, {"translation", {1, 0, 0}}});
    const std::size_t parent = b.root["nodes"].size() - 1;
    SceneDescription scene = b.load();
    EXPECT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.lights.size(), 1u);
    b.root["nodes"][parent]["extensions"] = hidden(false);
    scene = b.load();
    EXPECT_EQ(scene.instances.size(), 1u) << "a visible node below a hidden one is hidden";
    EXPECT_TRUE(scene.lights.empty());
    ASSERT_EQ(scene.cameras.size(), 1u) << "cameras look from hidden nodes as well";
    EXPECT_EQ(scene.cameras[0].toWorld.m[3], Vec3d(1, 0, 5));
    EXPECT_TRUE(scene.warnings.empty());
    // If all nodes of a mesh are hidden, there are no instances.
    b.root["nodes"][0]["extensions"] = hidden(false);
    scene = b.load();
    EXPECT_TRUE(scene.instances.empty());
    b.root["nodes"][0]["extensions"]["KHR_node_visibility"] = json::object();
    EXPECT_EQ(b.load().instances.size(), 1u);
    b.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = 0;
    expectRefused(b, {"nodes[0].extensions.KHR_node_visibility.visible"});
}

TEST(Node, LightGroupOfAMesh) {
    const json extras = {{"lacuna", {{"light_group", "key"}}}};
    const SceneDescription scene = withNode({{"extras", extras}}).load();
    ASSERT_EQ(scene.instances.size(), 1u);
    ASSERT_LT(scene.instances[0].lightGroup, scene.nodeGroups.size());
    EXPECT_EQ(scene.nodeGroups[scene.instances[0].lightGroup], "key");
    EXPECT_EQ(withNode(json::object()).load().instances.at(0).lightGroup, Instance::kNoGroup);
}

TEST(Node, NameOfAMesh) {
    const SceneDescription scene = withNode({{"name", "table"}}).load();
    ASSERT_EQ(scene.instances.size(), 1u);
    ASSERT_LT(scene.instances[0].nodeName, scene.nodeNames.size());
    EXPECT_EQ(scene.nodeNames[scene.instances[0].nodeName], "table");
    EXPECT_EQ(withNode(json::object()).load().instances.at(0).nodeName, Instance::kNoName);
}

TEST(Node, LightGroupsAreNames) {
    const auto refused = [](const json& lacuna, const std::string& part) {
        expectRefused(withNode({{"extras", {{"lacuna", lacuna}}}}),
                      {"nodes[0].extras.lacuna", part});
    };
    refused({{"light_group", 7}}, "a name");
    refused({{"light_group", ""}}, "a name");
    refused({{"light_group", json::array({"key"})}}, "a name");
    refused({{"light_group", json::array()}}, "a name");
    refused("{light_group: key}", "a JSON object");
    refused("7", "a JSON object");
    refused(true, "a JSON object");
}

TEST(Light, DefaultsOfASpot) {
    const SceneDescription scene = withLight({{"type", "spot"}, {"spot", json::object()}}).load();
    EXPECT_EQ(scene.lights[0].innerConeAngle, 0.0);
    EXPECT_NEAR(scene.lights[0].outerConeAngle, std::numbers::pi / 4, 1e-9);
    EXPECT_EQ(scene.lights[0].direction, Vec3d(0, 0, -1));
}

TEST(Light, RangeIsIgnoredAloud) {
    const SceneDescription scene = withLight({{"type", "point"}, {"range", 5}}).load();
    EXPECT_EQ(warningsWith(scene, "range"), 1);
}

TEST(Light, ImpossibleOnesAreRefused) {
    expectRefused(withLight({{"type", "tube"}}), {"lights[0].type", "tube"});
    expectRefused(withLight({{"type", "point"}, {"intensity", -1}}), {"lights[0].intensity"});
    expectRefused(withLight({{"type", "point"}, {"intensity", 1e300}}), {"lights[0].intensity"});
    expectRefused(withLight({{"type", "point"}, {"color", {1, -1, 1}}}), {"lights[0].color"});
    expectRefused(withLight({{"type", "point"}, {"color", {1, 1}}}), {"3 numbers"});
    const auto spot = [](double inner, double outer) {
        return withLight(
            {{"type", "spot"}, {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}});
    };
    expectRefused(spot(0, 0), {"outerConeAngle"});
    expectRefused(spot(0, 1.6), {"outerConeAngle"});
    expectRefused(spot(0.6, 0.5), {"innerConeAngle"});
    expectRefused(spot(-0.1, 0.5), {"innerConeAngle"});
    EXPECT_LE(spot(0.1, double(float(std::numbers::pi / 2))).load().lights[0].outerConeAngle,
              std::numbers::pi / 2);
}

/// No "found 0.000000" for a number that is refused because it is slightly below zero.
TEST(Light, MessagesShowTheNumberThatWasFound) {
    expectRefused(withLight({{"type", "point"}, {"intensity", -1e-46}}), {"found -1e-46;"});
    expectRefused(withLight({{"type", "point"}, {"intensity", 1e39}}), {"found 1e+39;"});
    GltfBuilder b;
    b.add("cameras", perspective(1e-46));
    b.rootNode({{"camera", 0}});
    expectRefused(b, {"cameras[0].perspective.yfov", "found 1e-46;"});
    TriangleBuilder extras;
    extras.extras()["lacuna"] = {{"focus", 1e39}};
    expectRefused(extras, {"a distance from 1e-15 to 1e17", "found 1e+39;"});
}

TEST(Extras, LacunaMembers) {
    TriangleBuilder b;
    EXPECT_FALSE(b.load().width);
    b.extras()["lacuna"] = {
        {"width", 640}, {"height", 480}, {"max_depth", 7}, {"aperture", 0.25}, {"focus", 3}};
    b.extras()["license"] = "CC0";  // extras of other programs are ignored
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.width, 640);
    EXPECT_EQ(scene.height, 480);
    EXPECT_EQ(scene.maxDepth, 7);
    EXPECT_EQ(scene.aperture, 0.25);
    EXPECT_EQ(scene.focus, 3.0);
    EXPECT_TRUE(scene.warnings.empty());
    b.extras()["lacuna"] = {{"widht", 640}};
    EXPECT_EQ(warningsWith(b.load(), "lacuna.widht"), 1);
}

TEST(Extras, LacunaMembersAreChecked) {
    const auto with = [](const char* name, const json& value) {
        TriangleBuilder b;
        b.extras()["lacuna"] = {{name, value}};
        return b;
    };
    for (const char* name : {"width", "height", "max_depth"}) {
        for (const json& bad : {json(0), json(-5), json(1.5), json("9"), json(5000000000),
                                json(18446744073709551615u), json(nullptr)}) {
            expectRefused(with(name, bad), {std::string("scene.extras.lacuna.") + name});
        }
    }
    for (const json& bad : {json(-0.1), json("f/2"), json(1e300), json(true)}) {
        expectRefused(with("aperture", bad), {"scene.extras.lacuna.aperture"});
        expectRefused(with("focus", bad), {"scene.extras.lacuna.focus"});
    }
    expectRefused(with("focus", 0), {"scene.extras.lacuna.focus"});
    TriangleBuilder b;
    b.extras()["lacuna"] = {640, 480};
    expectRefused(b, {"scene.extras.lacuna", "an object"});
}

/// Blender's custom properties are texts unless a script makes them.
TEST(Extras, TextsHoldObjects) {
    const TempDir dir;
    dir.write("sky.hdr", std::string("not looked into"));
    TriangleBuilder b;
    b.extras()["lacuna"] = R"( {"width": 640, "max_depth": 7, "apertur": 1})";
    b.extras()["environment"] =
        " {\"file\": \"sky.hdr\", \"scale\": 2, \"rotation_degrees\": 90}\n";
    const SceneDescription scene = loadGltf(dir.write("scene.glb", b.glb()));
    EXPECT_EQ(scene.width, 640);
    EXPECT_FALSE(scene.height);
    EXPECT_EQ(scene.maxDepth, 7);
    EXPECT_EQ(warningsWith(scene, "scene.extras.lacuna.apertur"), 1);
    ASSERT_TRUE(scene.environment);
    EXPECT_EQ(scene.environment->file, dir / "sky.hdr");
    EXPECT_EQ(scene.environment->scale, 2.0);
    EXPECT_EQ(scene.environment->rotationDegrees, 90.0);
}

TEST(Extras, TextsAreChecked) {
    const TempDir dir;
    dir.write("sky.hdr", std::string("x"));
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    for (const char* bad :
         {R"({"width": 640)", R"({'width': 640})", "width: 640", "", "640", "[640, 480]", "\"{}\"",
          R"({"width": 640} and more)", R"({"width": "640"})"}) {
        SCOPED_TRACE(bad);
        TriangleBuilder b;
        b.extras()["lacuna"] = bad;
        expectRefused(b, {"scene.extras.lacuna"});
    }
    for (const char* bad : {R"({"file": "sky.hdr")", R"({"scale": 2})", R"({"file": "sky.png"})",
                            "{}", R"({"file": "../sky.hdr"})"}) {
        SCOPED_TRACE(bad);
        TriangleBuilder b;
        b.extras()["environment"] = bad;
        expectRefused(dir.write("scene.glb", b.glb()), {"scene.extras.environment"});
    }
    TriangleBuilder b;
    b.extras()["lacuna"] = deep;
    expectRefused(b, {"nested"});
    b.extras()["lacuna"] = R"({"width": 640)";
    expectRefused(b, {R"({"width": 640)", "column 14", R"(such as {"width": 640})"});
}

TEST(Extras, Environment) {
    const TempDir dir;
    dir.write("sky.hdr", std::string("not looked into"));
    dir.write("maps/100%25.EXR", std::string("neither"));
    TriangleBuilder b;
    b.extras()["environment"] = "sky.hdr";
    SceneDescription scene = loadGltf(dir.write("scene.glb", b.glb()));
    ASSERT_TRUE(scene.environment);
    EXPECT_EQ(scene.environment->file, dir / "sky.hdr");
    EXPECT_EQ(scene.environment->scale, 1.0);
    EXPECT_EQ(scene.environment->rotationDegrees, 0.0);
    b.extras()["environment"] = {
        {"file", "maps/100%25.EXR"}, {"scale", 2.5}, {"rotation_degrees", -90}};
    scene = loadGltf(dir.write("scene.glb", b.glb()));
    EXPECT_EQ(scene.environment->file, dir / "maps/100%25.EXR");
    EXPECT_EQ(scene.environment->scale, 2.5);
    EXPECT_EQ(scene.environment->rotationDegrees, -90.0);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Extras, EnvironmentIsChecked) {
    const TempDir dir;
    dir.write("sky.hdr", std::string("x"));
    dir.write("sky.png", std::string("x"));
    for (const json& bad :
         {json("none.hdr"), json("../sky.hdr"), json("/etc/passwd"), json("sky.png"), json(""),
          json("http://a/b.hdr"), json(3), json(nullptr), json{{"scale", 1}}, json{{"file", 3}},
          json{{"file", "sky.hdr"}, {"scale", -1}}, json{{"file", "sky.hdr"}, {"scale", "much"}},
          json{{"file", "sky.hdr"}, {"rotation_degrees", "x"}}, json::array({"sky.hdr"})}) {
        SCOPED_TRACE(bad.dump());
        TriangleBuilder b;
        b.extras()["environment"] = bad;
        expectRefused(dir.write("scene.glb", b.glb()), {"environment"});
    }
}

}  // namespace
}  // namespace lacuna::test
