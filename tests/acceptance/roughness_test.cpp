// Hard cases of materials: roughness from 1 to the limit at which lobes become deltas, and beyond
// it.
#include <gtest/gtest.h>

#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

/// The roughness of the smoothest rough lobe: its alpha is just above kMinAlpha, where deltas
/// begin.
constexpr float kLimit = 0.0100001f;
/// Below this roughness a splat meets the lobe of what the lens sees too rarely for a z-test on few
/// samples.
constexpr float kSplatsSee = 0.3f;

/// A floor and a wall, with a box and a ball of that material, under a large light.
SceneBuilder objects(const lacuna::Material& material) {
    SceneBuilder b;
    const auto wall = b.add(matte({0.7f, 0.5f, 0.3f}));
    const auto m = b.add(material);
    b.add(quad({-1.5f, 0, 1.5f}, {3, 0, 0}, {0, 0, -3}));
    b.add(quad({-1.5f, 0, -1}, {3, 0, 0}, {0, 1.5f, 0}, wall));
    b.add(box({-0.7f, 0.05f, -0.5f}, {-0.1f, 0.7f, 0}, m),
          translation({-0.4, 0, -0.3}) * rotation({0, 1, 0}, 25) * translation({0.4, 0, 0.3}));
    b.add(sphere({0.5f, 0.4f, 0.1f}, 0.35f, 12, m));
    b.add(quad({-1, 2, -0.5f}, {2, 0, 0}, {0, 0, 1.5f}, b.add(emitter(Rgb(2.0f)))));
    b.add(lookAt({0, 0.9, 3}, {0, 0.4, 0}, 38));
    return b;
}

struct Kind {
    std::string name;
    lacuna::Material (*make)(float roughness);
    Rows rows;
};
void PrintTo(const Kind& k, std::ostream* out) {
    *out << k.name;
}
lacuna::Material makeMetal(float roughness) {
    return metal({0.9f, 0.8f, 0.7f}, roughness);
}
lacuna::Material makeGlass(float roughness) {
    return glass(1.5f, roughness);
}
lacuna::Material makeCoat(float roughness) {
    return plastic({0.4f, 0.2f, 0.1f}, roughness);
}

class RoughnessSlow : public testing::TestWithParam<Kind> {};

Shot shot(std::uint64_t seed, int iterations) {
    Shot s;
    s.width = s.height = 12;
    s.maxDepth = 5;
    s.iterations = iterations;
    s.lightPaths = 512;
    s.seed = seed;
    return s;
}

TEST_P(RoughnessSlow, rowsAgreeDownToTheDelta) {
    for (const float roughness : {1.0f, 0.3f, 0.1f, kLimit, 1e-3f, 1e-4f, 0.0f}) {
        const auto scene = objects(GetParam().make(roughness)).build();
        const Picture reference = render(*scene, pathTracer(), shot(100, 200));
        for (const std::string& name : rowNames(GetParam().rows)) {
            const MethodRow row = rowNamed(name);
            const std::string what = name + ", roughness " + std::to_string(roughness);
            if (!seesThroughDeltas(row) && roughness < kSplatsSee) {
                EXPECT_EQ(render(*scene, row, shot(1, 10)).statistics.invalidSamples, 0u) << what;
                continue;
            }
            expectSame(render(*scene, row, shot(1, 100)), reference, what, Judge::BlocksAndMean);
        }
    }
    stabilityCase("roughness", worstDeviation(), kOfAllowed);
}

TEST_P(RoughnessSlow, theLimitMeetsTheDelta) {
    const auto rough = objects(GetParam().make(kLimit)).build();
    const auto delta = objects(GetParam().make(0)).build();
    for (const std::string& name : rowNames(GetParam().rows)) {
        const MethodRow row = rowNamed(name);
        if (!seesThroughDeltas(row)) continue;
        expectSame(render(*rough, row, shot(1, 150)), render(*delta, row, shot(2, 150)),
                   name + ", limit of " + GetParam().name, Judge::BlocksAndMean);
    }
    stabilityCase("delta-limit", worstDeviation(), kOfAllowed);
}

std::vector<Kind> kindsFor(Rows (*rowsOfScene)(std::size_t)) {
    return {{"metal", makeMetal, rowsOfScene(0)},
            {"glass", makeGlass, rowsOfScene(1)},
            {"coat", makeCoat, rowsOfScene(2)}};
}
INSTANTIATE_TEST_SUITE_P(Day, RoughnessSlow, testing::ValuesIn(kindsFor(halfOfADay)),
                         ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, RoughnessSlow, testing::ValuesIn(kindsFor(halfOfANight)),
                         ByParameter());
INSTANTIATE_TEST_SUITE_P(NightOfTests, RoughnessSlow,
                         testing::ValuesIn(kindsFor([](std::size_t) { return Rows::OfTests; })),
                         ByParameter());

}  // namespace
}  // namespace lacuna::test
