// Acceptance 6: every row against path tracing. First in one small scene, with pairs of light kinds (at night with
// every pair of lights without alpha); it has no deltas, so that path tracing and light tracing see everything. Then in
// the scenes of the repository. expectSame() prints the smallest bias that each comparison can see.
#include <gtest/gtest.h>

#include "libcore/gltf/gltf.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

struct Pair {
    LightChoice a, b;
    Rows rows = Rows::OfTheTool;
};
void PrintTo(const Pair& p, std::ostream* out) {
    *out << nameOf(p.a) << " and " << nameOf(p.b);
}
/// Every kind of light at least once, and those with alpha beside lights that they could be mistaken for.
std::vector<Pair> pairsOfADay() {
    using enum LightChoice;
    std::vector<Pair> pairs = {{Quad, Environment},
                               {Sphere, Spot},
                               {TwoSided, Directional},
                               {Point, Environment},
                               {Hidden, Sphere},
                               {Quad, Veiled},
                               {VeiledTexture, MaskedTexture},
                               {MaskedTexture, Environment}};
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].rows = halfOfADay(i);
    return pairs;
}
std::vector<Pair> pairsOfANight() {
    std::vector<Pair> pairs = pairsOfADay();
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].rows = halfOfANight(i);
    for (int i = 0; i < kLightChoices; ++i) {
        for (int j = i + 1; j < kLightChoices; ++j) {
            const Pair p{LightChoice(i), LightChoice(j)};
            const auto isTheSame = [&](const Pair& day) { return day.a == p.a && day.b == p.b; };
            if (std::ranges::none_of(pairs, isTheSame)) pairs.push_back(p);
        }
    }
    return pairs;
}
std::vector<Pair> pairsByRowsOfTests() {
    std::vector<Pair> pairs = pairsOfADay();
    for (Pair& p : pairs) p.rows = Rows::OfTests;
    return pairs;
}

class LightPairsSlow : public testing::TestWithParam<Pair> {};

TEST_P(LightPairsSlow, everyRowAgreesWithPathTracing) {
    SceneBuilder b = stage();
    addLight(b, GetParam().a);
    addLight(b, GetParam().b);
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 4;
    shot.iterations = 400;
    shot.seed = 100;
    const Picture reference = render(*scene, pathTracer(), shot);
    shot.seed = 1;
    shot.iterations = 200;
    shot.lightPaths = 1024;
    for (const std::string& name : rowNames(GetParam().rows)) {
        const MethodRow row = rowNamed(name);
        if (mergesBetweenDeltas(row)) continue;
        Shot its = withSplatsForEveryPixel(shot, row);
        // Weights that trust nonsense make large samples so rare that 200 iterations may meet none of them in a pixel.
        if (name == "test-hashed-density") its.iterations = 1600;
        expectSame(render(*scene, row, its), reference, name);
    }
    const bool alpha = std::max(GetParam().a, GetParam().b) > LightChoice::Environment;
    if (alpha) {
        stabilityCase("lamps-with-alpha", worstDeviation(), kOfAllowed);
    } else {
        stabilityCase("light-kinds", worstDeviation(), kOfAllowed);
    }
}

INSTANTIATE_TEST_SUITE_P(Day, LightPairsSlow, testing::ValuesIn(pairsOfADay()), ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, LightPairsSlow, testing::ValuesIn(pairsOfANight()), ByParameter());
INSTANTIATE_TEST_SUITE_P(NightOfTests, LightPairsSlow, testing::ValuesIn(pairsByRowsOfTests()),
                         ByParameter());

/// A colour that one vertex absorbs may be all that the vertex beside it reflects. What is learned at one and used at
/// the other has to allow for that.
class PureColoursSlow : public testing::TestWithParam<Rows> {};
INSTANTIATE_TEST_SUITE_P(Day, PureColoursSlow, testing::Values(Rows::SecondHalf), ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, PureColoursSlow, testing::Values(Rows::FirstHalf), ByParameter());
TEST_P(PureColoursSlow, everyRowAgreesWithBpt) {
    const auto scene = tilesOfPureColours(Rgb(0.9f)).build();
    Shot shot;
    shot.maxDepth = 6;
    shot.iterations = 1200;
    shot.seed = 100;
    const Picture reference = render(*scene, rowNamed("bpt"), shot);
    shot.seed = 1;
    shot.iterations = 300;
    shot.lightPaths = 1024;
    for (const std::string& name : rowNames(GetParam())) {
        const MethodRow row = rowNamed(name);
        if (mergesBetweenDeltas(row)) continue;
        expectSame(render(*scene, row, withSplatsForEveryPixel(shot, row)), reference, name,
                   Judge::BlocksAndMean);
    }
    stabilityCase("pure-colours", worstDeviation(), kOfAllowed);
}

// Scenes of the repository
// -------------------------------------------------------------------------

struct SceneFile {
    std::string name;
    int iterations;
    /// Gloss gathers the light of a small or punctual light: eye walks alone meet it too rarely for a z-test. So the
    /// reference is bpt. Rows whose light walks go no further than y_0 are left out, and so are the tests' own rows:
    /// their weights trust nonsense on purpose, and their large samples are too rare at 240 iterations. light-spot has
    /// 1920 iterations: some of its blocks are so dark that after 240, and once after 960, a row had not met most of
    /// their variance.
    bool caustics = false;
    int width = 32, height = 24;  ///< fewer pixels mean fewer blocks to judge, each as sharply
    int depth = 5;                ///< edges of the longest path
    Rows rows = Rows::OfTheTool;
};
void PrintTo(const SceneFile& s, std::ostream* out) {
    *out << s.name;
}

/// Whether any material has a perfectly smooth lobe: then the lens sees some things through deltas.
bool hasDeltas(const SceneDescription& scene) {
    for (const lacuna::Material& m : scene.materials) {
        const bool layered = m.metallic > 0 || m.transmission > 0 || (m.specular > 0 && m.ior > 1);
        if (layered && double(m.roughness) * double(m.roughness) < double(kMinAlpha)) return true;
    }
    return false;
}

class SceneFilesSlow : public testing::TestWithParam<SceneFile> {};

TEST_P(SceneFilesSlow, everyRowAgreesWithTheReference) {
    const SceneDescription description =
        loadGltf(std::string(LACUNA_SCENES "/") + GetParam().name + ".glb");
    const Scene scene(description, pool());
    Shot shot;
    shot.width = GetParam().width;
    shot.height = GetParam().height;
    shot.maxDepth = GetParam().depth;
    shot.iterations = 2 * GetParam().iterations;
    shot.seed = 100;
    const Picture reference =
        render(scene, GetParam().caustics ? rowNamed("bpt") : pathTracer(), shot);
    shot.seed = 1;
    shot.iterations = GetParam().iterations;
    for (const std::string& name : rowNames(GetParam().rows)) {
        const MethodRow row = rowNamed(name);
        if (hasDeltas(description) ? !seesThroughDeltas(row) : mergesBetweenDeltas(row)) continue;
        if (GetParam().caustics && !walksFromLights(row)) continue;
        Shot its = withSplatsForEveryPixel(shot, row);
        // Rows that merge have no next event along known ways: after 240 iterations blocks of kitchen-glass are too
        // dark by up to 6 of their own errors.
        if (GetParam().caustics && merges(row)) its.iterations *= 4;
        expectSame(render(scene, row, its), reference, name, Judge::BlocksAndMean);
    }
}

std::vector<SceneFile> sceneFilesOfADay() {
    std::vector<SceneFile> files = {{"cornell-box", 100},
                                    {"door", 60},
                                    {"glossy-room", 240, true, 24, 18},
                                    {"kitchen-glass", 240, true, 24, 18},
                                    {"night-window", 240, true, 24, 18, 8},  // four faces of panes
                                    {"ring-caustic", 240, true, 24, 18},
                                    {"furnace", 40},
                                    {"light-quad", 60},
                                    {"light-sphere", 60},
                                    {"light-two-sided", 60},
                                    {"light-point", 60},
                                    {"light-directional", 60},
                                    {"light-environment", 60},
                                    {"light-mesh-instanced", 60}};
    for (std::size_t i = 0; i < files.size(); ++i) files[i].rows = halfOfADay(i);
    return files;
}
std::vector<SceneFile> sceneFilesOfANight() {
    std::vector<SceneFile> files = sceneFilesOfADay();
    for (std::size_t i = 0; i < files.size(); ++i) files[i].rows = halfOfANight(i);
    files.push_back({"light-spot", 1920, true, 20, 15});
    return files;
}
std::vector<SceneFile> sceneFilesByRowsOfTests() {
    std::vector<SceneFile> files = sceneFilesOfADay();
    std::erase_if(files, [](const SceneFile& file) { return file.caustics; });
    for (SceneFile& file : files) file.rows = Rows::OfTests;
    return files;
}
INSTANTIATE_TEST_SUITE_P(Day, SceneFilesSlow, testing::ValuesIn(sceneFilesOfADay()), ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, SceneFilesSlow, testing::ValuesIn(sceneFilesOfANight()),
                         ByParameter());
INSTANTIATE_TEST_SUITE_P(NightOfTests, SceneFilesSlow, testing::ValuesIn(sceneFilesByRowsOfTests()),
                         ByParameter());

}  // namespace
}  // namespace lacuna::test
