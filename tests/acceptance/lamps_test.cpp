// Next event picks lamps by what a vertex sees of them, or by power: both make the same picture, under lamps of all
// kinds at once.
#include <gtest/gtest.h>

#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

SceneBuilder underLampsOfAllKinds() {
    SceneBuilder b = stage();
    for (int i = 0; i < kLightChoices; ++i) addLight(b, LightChoice(i), 0.3f);
    addLight(b, LightChoice::VeiledTexture);
    addLight(b, LightChoice::MaskedTexture);
    return b;
}

class LampsSeen : public testing::TestWithParam<std::string> {};

TEST_P(LampsSeen, makeThePictureThatPowerMakes) {
    const auto scene = underLampsOfAllKinds().build();
    const MethodRow row = rowNamed(GetParam());
    Shot shot = quickShot(300);
    shot.seed = 100;
    const Picture reference = render(*scene, pathTracer(), shot);
    shot.seed = 1;
    for (const char* lamps : {"lamps=seen", "lamps=power"}) {
        shot.settings = {lamps};
        expectSame(render(*scene, row, shot), reference, row.name + " " + lamps);
    }
}
INSTANTIATE_TEST_SUITE_P(All, LampsSeen, testing::Values("pt", "bpt", "risbpt", "tsrbpt"),
                         ByParameter());

// Next event leaves a part of the sky to hits. Without hits it has to bring all of it.
TEST(SkySeen, isWholeWithHitsAndWithout) {
    for (const bool even : {true, false}) {
        SceneBuilder b = stage();
        addLight(b, LightChoice::Directional, 0.3f);
        addLight(b, LightChoice::Environment);
        if (even) b.d.environment->colour = Rgb(0.5f, 0.7f, 1.0f);
        const auto scene = b.build();
        Shot shot = quickShot(300);
        shot.transparentBackground = true;  // leaves out what only hits can bring
        MethodRow row = rowNamed("pt");
        row.techniques.hits = false;
        const Picture without = render(*scene, row, shot);
        shot.seed = 100;
        for (const char* method : {"pt", "bpt"}) {
            const std::string name =
                std::string(method) + (even ? ", even sky" : ", sky with a sun");
            for (const char* lamps : {"lamps=seen", "lamps=power"}) {
                shot.settings = {lamps};
                expectSame(render(*scene, rowNamed(method), shot), without, name + ", " + lamps);
                ++shot.seed;
            }
        }
    }
}

}  // namespace
}  // namespace lacuna::test
