// The group of each light.
#include <gtest/gtest.h>

#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

Mesh lampMesh(std::uint32_t material) {
    return quad({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, material);
}

TEST(LightGroupNames, NodeThenMaterialThenTheMaterialsName) {
    SceneBuilder b;
    lacuna::Material named = emitter(Rgb(1.0f)), grouped = emitter(Rgb(1.0f));
    named.name = "tube";
    grouped.name = "panel";
    grouped.lightGroup = "work";
    const std::uint32_t nameless = b.add(emitter(Rgb(1.0f)));
    const auto mesh = b.add(lampMesh(b.add(named)));
    b.instance(mesh, translation({3, 0, 0}));  // the same mesh under a node of another group
    b.d.nodeGroups = {"key"};
    b.d.instances.back().lightGroup = 0;
    b.add(lampMesh(b.add(grouped)), translation({6, 0, 0}));
    b.add(lampMesh(nameless), translation({9, 0, 0}));
    b.add(lampMesh(0), translation({12, 0, 0}));  // does not shine
    const auto scene = b.build();
    const LightGroups groups = scene->lightGroups();
    EXPECT_EQ(groups.names, (std::vector<std::string>{"tube", "key", "work", "unnamed"}));
    EXPECT_EQ(groups.group, (std::vector<std::uint32_t>{0, 0, 1, 1, 2, 2, 3, 3}));
    EXPECT_EQ(groups.group.size(), scene->lights().size());
}

TEST(LightGroupNames, LampsOfAllKindsShareGroups) {
    SceneBuilder b;
    b.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
    lacuna::Material lamp = emitter(Rgb(1.0f));
    lamp.lightGroup = "warm";
    b.add(lampMesh(b.add(lamp)), translation({0, 1, 0}));
    for (const char* name : {"warm", "cold", "", "warm"}) {
        PunctualLight light = pointLight({0, 2, 0}, Rgb(1.0f));
        light.group = name;
        b.add(light);
    }
    b.d.environment = EnvironmentDescription{};
    b.d.environment->colour = Rgb(0.1f);
    const auto scene = b.build();
    const LightGroups groups = scene->lightGroups();
    EXPECT_EQ(groups.names, (std::vector<std::string>{"warm", "cold", "unnamed", "environment"}));
    EXPECT_EQ(groups.group, (std::vector<std::uint32_t>{0, 0, 0, 1, 2, 0, 3}));
    EXPECT_EQ(groups.group.size(), scene->lights().size());
    EXPECT_EQ(groups.names[groups.group[scene->lights().environmentIndex()]], "environment");
}

TEST(LightGroupNames, NoLightIsInNoGroup) {
    SceneBuilder b;
    b.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
    EXPECT_TRUE(b.build()->lightGroups().names.empty());
}

}  // namespace
}  // namespace lacuna::test
