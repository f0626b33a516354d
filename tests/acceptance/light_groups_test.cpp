// Layers of light groups: each holds the light of its lamps and of no others, whichever technique made the paths.
// Together they are the picture.
#include <gtest/gtest.h>

#include <array>

#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

/// A mesh, a bulb and a sky that shine in one channel each, around things that keep channels apart.
SceneBuilder primaryColours() {
    SceneBuilder b;
    b.add(quad({-1.5f, 0, 1.5f}, {3, 0, 0}, {0, 0, -3}));
    b.add(sphere({0.5f, 0.4f, 0}, 0.35f, 12, b.add(glass(1.5f))));
    b.add(sphere({-0.5f, 0.4f, 0}, 0.35f, 12, b.add(metal(Rgb(0.9f), 0.3f))));
    b.add(quad({-1.5f, 0, -1.2f}, {3, 0, 0}, {0, 2, 0}, b.add(mirror())));
    lacuna::Material lamp = emitter({2, 0, 0});
    lamp.name = "lamp";
    b.add(quad({-0.4f, 1.6f, 0.2f}, {0.8f, 0, 0}, {0, 0.1f, 0.7f}, b.add(lamp)));
    PunctualLight bulb = pointLight({-0.9, 1.1, 0.6}, {0, 0.5f, 0});
    bulb.group = "bulb";
    b.add(bulb);
    b.d.environment = EnvironmentDescription{};
    b.d.environment->colour = Rgb{0, 0, 0.2f};
    b.add(lookAt({0.2, 0.9, 2.6}, {0, 0.5, 0}, 55));
    return b;
}

class LightGroupsOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, LightGroupsOf, testing::ValuesIn(rowNamesOfWeights()), ByParameter());

TEST_P(LightGroupsOf, HoldTheirLampsAndAddUpToThePicture) {
    const auto scene = primaryColours().build();
    Shot shot;
    shot.iterations = 24;
    shot.radius = 0.1;  // of merging, large enough that there are merges
    const PathLayers groups(*scene, true, {});
    shot.layers = &groups;
    const Picture p = render(*scene, rowNamed(GetParam()), shot);
    const Image picture = p.pixels.image();

    const Layers& layers = p.layers;
    const std::array<std::string, 3> names{"lamp", "bulb", "environment"};
    const std::array<std::string, 3> channels{".R", ".G", ".B"};
    ASSERT_EQ(layers.size(), 9u);
    for (std::size_t c = 0; c < 3; ++c) {
        double energy = 0.0;
        for (std::size_t g = 0; g < 3; ++g) {
            const std::vector<float>& plane = layers.at("light." + names[g] + channels[c]);
            for (std::size_t i = 0; i < plane.size(); ++i) {
                const Rgb& pixel = picture.pixels[i];
                const float whole = c == 0 ? pixel.r : c == 1 ? pixel.g : pixel.b;
                ASSERT_NEAR(plane[i], g == c ? whole : 0.0f, 1e-6f * whole)
                    << names[g] << channels[c] << ", pixel " << i;
                energy += double(plane[i]);
            }
        }
        EXPECT_GT(energy, 0.0) << names[c];
    }
}

}  // namespace
}  // namespace lacuna::test
