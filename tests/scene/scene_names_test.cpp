// The names of lights and objects.
#include <gtest/gtest.h>

#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

using Names = std::vector<std::string>;

TEST(SceneNames, OfNodesAndMaterials) {
    SceneBuilder b;
    lacuna::Material tube = emitter(Rgb(1.0f));
    tube.name = "tube";
    b.d.nodeNames = {"left", "right"};
    const auto mesh = b.add(quad({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add(tube)));
    b.d.instances.back().nodeName = 1;
    b.instance(mesh, translation({3, 0, 0}));
    b.add(quad({-1, 0, 3}, {1, 0, 0}, {0, 1, 0}));
    b.d.instances.back().nodeName = 0;
    const auto scene = b.build();
    EXPECT_EQ(scene->objectNames(),
              (std::vector<ObjectNames>{{"right", "tube"}, {"", "tube"}, {"left", ""}}));
}

TEST(SceneNames, OfLightsInTheirOrder) {
    SceneBuilder b;
    lacuna::Material tube = emitter(Rgb(1.0f));
    tube.name = "tube";
    tube.lightGroup = "work";
    b.add(quad({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add(tube)));
    PunctualLight bulb = pointLight({0, 2, 0}, Rgb(1.0f));
    bulb.names = {"bulb", "Light.001"};
    bulb.group = "key";
    b.add(bulb);
    b.d.environment = EnvironmentDescription{};
    b.d.environment->colour = Rgb(0.1f);
    const auto scene = b.build();
    const std::vector<NamedLights> lights = scene->namedLights();
    ASSERT_EQ(lights.size(), 3u);
    EXPECT_EQ(lights[0].kind, NamedLights::Kind::Mesh);
    EXPECT_EQ(lights[0].count, 2u);
    EXPECT_EQ(lights[0].group, "work");
    EXPECT_EQ(lights[0].names, Names{"tube"});
    EXPECT_EQ(lights[1].kind, NamedLights::Kind::Lamp);
    EXPECT_EQ(lights[1].group, "key");
    EXPECT_EQ(lights[1].names, (Names{"bulb", "Light.001"}));
    EXPECT_EQ(lights[2].kind, NamedLights::Kind::Environment);
    EXPECT_EQ(lights[2].group, "environment");
    EXPECT_EQ(lights[2].count, 1u);
}

}  // namespace
}  // namespace lacuna::test
