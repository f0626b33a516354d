// Next event by what a vertex sees of the lamps against next event by power: the same picture, under
// lamps of all kinds at once.
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

}  // namespace
}  // namespace lacuna::test
