// Lamps and skies behind smooth glass, by next event through it: no light is lost or counted twice, in any
// row that has it. (theory.md, "Next event through glass")
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "libcore/material/fresnel.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

class RefractedLampsOf : public RowTest {};
INSTANTIATE_TEST_SUITE_P(All, RefractedLampsOf,
                         testing::ValuesIn(rowNamesWith(&Techniques::refract, Rows::OfTheTool)),
                         ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, RefractedLampsOf,
                         testing::ValuesIn(rowNamesWith(&Techniques::refract, Rows::OfTests)),
                         ByParameter());

/// A floor under a slab of glass under an even sky gets what both faces let through, from all directions. Next event
/// leaves all of such a sky to hits, unless a guide tells where to look.
TEST_P(RefractedLampsOf, skyThroughASlab) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(quad({-90, 0, 90}, {180, 0, 0}, {0, 0, -180}));
    b.add(box({-90, 1, -90}, {90, 1.2f, 90}, b.add(glass())));
    b.add(lookAt({0.3, 0.8, 0.9}, {0, 0, 0.2}, 40));
    b.environment(constantSky(2));
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 4;  // nothing is reflected back
    shot.iterations = 300;
    shot.lightPaths = 256;
    std::atomic<int> refractions{0};
    shot.observer = [&](const PathEvent& event) { refractions += event.technique.refracts(); };
    double open = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
        const double squaredSine = (i + 0.5) / kSteps;  // evenly by projected solid angle
        const double f = fresnelDielectric(std::sqrt(1 - squaredSine), 1.5);
        open += (1 - f) * (1 - f) / kSteps;
    }
    // The slab ends where the sky lies 89 degrees from the vertical.
    const double exact = 0.6 * 2 * open;
    expectRadiance(render(*scene, row(), shot), exact, row().name + ", sky and slab",
                   Judge::MeanOnly);
    EXPECT_EQ(refractions, 0);
    shot.guide = 5;
    expectRadiance(render(*scene, row(), shot), exact, row().name + ", sky and slab, guided",
                   Judge::MeanOnly);
    EXPECT_GT(refractions, 2500);
}

/// A stage for a wide lamp, below things that bend and colour its light: a slab with a relief, a ball with smooth
/// normals, and blocks that absorb. One block is turned and mirrored, the other is under a veil.
SceneBuilder glassAboveAStage() {
    SceneBuilder b;
    // Half a mirror, half a colour: walks go on from it by either, and connections end at it.
    b.d.materials[0] = plastic({0.5f, 0.4f, 0.3f}, 0);
    b.d.materials[0].metallic = 0.5f;
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    b.add(quad({-2, 0, -1.2f}, {4, 0, 0}, {0, 2, 0}, b.add(plastic({0.2f, 0.4f, 0.3f}, 0))));
    lacuna::Material bumpy = glass(1.3f);
    bumpy.normalTexture = b.add(waves());
    bumpy.normalScale = 0.1f;
    b.add(box({-1.6f, 1, -0.5f}, {-0.5f, 1.1f, 0.6f}, b.add(bumpy)));
    b.add(sphere({0, 0.7f, 0.1f}, 0.4f, 24, b.add(colouredGlass({0.2f, 0.5f, 0.1f}, 1.1f)), true));
    const auto coloured = b.add(colouredGlass({0.8f, 0.3f, 0.2f}, 1.5f));
    const auto block = b.add(box({0.6f, 0.8f, -0.4f}, {1.6f, 1, 0.6f}, coloured));
    b.instance(block,
               translation({0.1, -0.4, 0.9}) * rotation({1, 0, 1}, 20) * scaling({-1, 1, 1}));
    lacuna::Material veil = matte(Rgb(0.6f));
    veil.alphaMode = lacuna::Material::Alpha::Blend;
    veil.baseAlpha = 0.5f;
    b.add(quad({0.5f, 1.3f, 0.6f}, {1.2f, 0, 0}, {0, 0, -1.1f}, b.add(veil)));
    b.add(lookAt({0.3, 1.3, 3}, {0, 0.4, 0}, 45));
    return b;
}

/// The same with glass that is nearly smooth, and with smooth glass before and behind it.
SceneBuilder facetsAboveAStage() {
    SceneBuilder b;
    b.d.materials[0] = plastic({0.5f, 0.4f, 0.3f}, 0.1f);  // narrow lobes above a colour
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    b.add(quad({-2, 0, -1.2f}, {4, 0, 0}, {0, 2, 0}, b.add(metal({0.7f, 0.8f, 0.9f}, 0.2f))));
    lacuna::Material bumpy = glass(1.3f, 0.15f);
    bumpy.normalTexture = b.add(waves());
    bumpy.normalScale = 0.1f;
    b.add(box({-1.6f, 1, -0.5f}, {-0.5f, 1.1f, 0.6f}, b.add(bumpy)));
    b.add(sphere({0, 0.7f, 0.1f}, 0.4f, 24, b.add(glass(1.1f, 0.25f)), true));
    lacuna::Material coloured = colouredGlass({0.8f, 0.3f, 0.2f}, 1.5f);
    coloured.roughness = 0.2f;
    b.add(box({0.5f, 0.8f, -0.4f}, {1.6f, 1, 0.6f}, b.add(coloured)));
    b.add(box({0.4f, 0.6f, -0.4f}, {1.3f, 0.7f, 0.8f}, b.add(glass(1.4f))));
    lacuna::Material sheet = pane({0.7f, 0.9f, 0.8f});
    sheet.roughness = 0.2f;
    b.add(quad({-0.4f, 1.2f, 0.9f}, {0.9f, 0.2f, 0}, {0, 0, -1}, b.add(sheet)));
    b.add(box({-1.4f, 1.3f, -0.4f}, {-0.4f, 1.4f, 0.6f}, b.add(glass(1.4f))));
    b.add(lookAt({0.3, 1.3, 3}, {0, 0.4, 0}, 45));
    return b;
}

/// Adds a ball in a block of glass; the ball sees a lamp through several of the block's faces.
void addBallInABlock(SceneBuilder& b, float roughness = 0) {
    b.add(box({-0.5f, -0.3f, -0.5f}, {0.5f, 0.3f, 0.5f}, b.add(glass(1.4f, roughness))),
          translation({-0.8, 0.4, -0.1}) * rotation({1, 3, 1}, 20) * scaling({-1, 1, 1}));
    b.add(sphere({-0.8f, 0.4f, -0.1f}, 0.2f, 8, b.add(matte({0.7f, 0.3f, 0.2f}))));
}

/// Such a ball on a floor, without lamps.
SceneBuilder ballInABlock(float roughness = 0) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.5f));
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    addBallInABlock(b, roughness);
    b.add(lookAt({0.3, 1.3, 2.4}, {-0.8, 0.4, -0.1}, 24));
    return b;
}

struct Lit {
    const char* name;
    void (*light)(SceneBuilder&);
};
constexpr Lit kLampWithAlpha{
    "lamp with alpha", [](SceneBuilder& b) {
        lacuna::Material lamp = emitter({2, 3, 4}, true);
        lamp.alphaMode = lacuna::Material::Alpha::Blend;
        lamp.baseAlpha = 0.4f;
        b.add(quad({-1.8f, 2, -1.2f}, {3.6f, 0, 0}, {0, 0, 2.4f}, b.add(lamp)));
    }};
constexpr Lit kSkyAlone{"sky", [](SceneBuilder& b) { b.environment(constantSky(2)); }};
void PrintTo(const Lit& lit, std::ostream* out) {
    *out << lit.name;
}

/// Compared with walks alone, which run into light this wide.
class BehindGlass : public testing::TestWithParam<Lit> {};
INSTANTIATE_TEST_SUITE_P(All, BehindGlass, testing::Values(kLampWithAlpha, kSkyAlone),
                         ByParameter());

void comparedWithWalks(SceneBuilder b, const Lit& lit) {
    lit.light(b);
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 7;
    shot.iterations = 3000;
    shot.seed = 100;
    const Picture walks = render(*scene, withoutRefractions(rowNamed("pt")), shot);
    shot.seed = 1;
    shot.iterations = 1200;
    for (const char* name : {"pt", "spcbpt", "vcm"}) {
        expectSame(render(*scene, rowNamed(name), shot), walks,
                   std::string(name) + ", " + lit.name + " behind glass", Judge::BlocksAndMean);
    }
}

TEST_P(BehindGlass, isWhatWalksFind) {
    comparedWithWalks(glassAboveAStage(), GetParam());
}

TEST_P(BehindGlass, isWhatWalksFindInABlock) {
    comparedWithWalks(ballInABlock(), GetParam());
}

/// The same through nearly smooth glass. Here also lights without a size: walks alone find them by next event at the
/// outermost surface.
class BehindFacets : public testing::TestWithParam<Lit> {};
constexpr Lit kWithoutASize{"lights without a size", [](SceneBuilder& b) {
                                addLight(b, LightChoice::Point);
                                addLight(b, LightChoice::Directional);
                            }};
INSTANTIATE_TEST_SUITE_P(Day, BehindFacets, testing::Values(kSkyAlone), ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, BehindFacets, testing::Values(kLampWithAlpha, kWithoutASize),
                         ByParameter());

TEST_P(BehindFacets, isWhatWalksFind) {
    comparedWithWalks(facetsAboveAStage(), GetParam());
}

TEST_P(BehindFacets, isWhatWalksFindInABlock) {
    comparedWithWalks(ballInABlock(0.2f), GetParam());
}

/// A lamp in a bulb: one surface of glass, with vertices inside and outside of it.
TEST_P(RefractedLampsOf, lampInABulb) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.5f));
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    b.add(sphere({0, 0.9f, 0}, 0.5f, 16, b.add(glass(1.2f)), true));
    b.add(sphere({0, 0.9f, 0}, 0.3f, 12, b.add(emitter(Rgb(3.0f)))));
    b.add(lookAt({0.3, 1.3, 3}, {0, 0.4, 0}, 45));
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 5;
    shot.iterations = 4000;
    shot.seed = 100;
    static const Picture walks = render(*scene, withoutRefractions(rowNamed("pt")), shot);
    shot.seed = 1;
    shot.iterations = 300;
    shot.lightPaths = 1024;
    expectSame(render(*scene, row(), shot), walks, row().name + ", lamp in a bulb",
               Judge::BlocksAndMean);
}

/// The technique makes nearly all paths by which the lamp lights the ball through one face. It finds not only the face
/// that the straight line meets, and loses none where that line would be reflected back.
TEST(RefractedLamps, shineThroughEachFace) {
    SceneBuilder b = ballInABlock();
    b.add(quad({0.6f, 1.8f, 0.4f}, {0.2f, 0, 0}, {0, -0.2f, 0.2f}, b.add(emitter(Rgb(70.0f)))));
    const auto scene = b.build();
    Shot shot = quickShot(3000);
    shot.maxDepth = 4;
    double known = 0, all = 0;
    shot.observer = [&](const PathEvent& event) {
        const FullPath& path = event.path;
        const bool throughOneFace = path.edges == 4 && path.delta[1] && !path.delta[2] &&
                                    path.vertex[1]->event == ScatterEvent::DeltaTransmission;
        if (event.technique.refracts() || !throughOneFace) return;
        const double light = double(mean(event.contribution)) / event.weight;
        all += light;
        if (path.refracted.ratio > 0) known += light;
    };
    render(*scene, rowNamed("pt"), shot);
    EXPECT_GT(known, 0.95 * all) << all;
}

/// What a path adds by this technique, and by an eye walk that runs into the lamp, are in the ratio of the densities in
/// the weights. With other densities the weights would still be unbiased, but worse.
TEST(RefractedLamps, knowTheirDensity) {
    struct Kind {
        bool alpha;
        float roughness;
    };
    for (const auto& [alpha, roughness] : {Kind{false, 0}, Kind{true, 0}, Kind{true, 0.2f}}) {
        SceneBuilder b;
        b.d.materials[0] = plastic({0.5f, 0.4f, 0.3f}, 0.6f);
        b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
        b.add(box({-3, 1, -3}, {3, 1.1f, 3}, b.add(glass(1.5f, roughness))));
        b.add(sphere({0.5f, 0.5f, 0.2f}, 0.3f, 16, b.add(glass(1.2f, roughness)), true));
        addBallInABlock(b, roughness);
        lacuna::Material lamp = emitter({2, 3, 4}, true);
        if (alpha) {
            lamp.alphaMode = lacuna::Material::Alpha::Blend;
            lamp.baseAlpha = 0.3f;
        }
        b.add(quad({-0.5f, 1.8f, -0.5f}, {1, 0, 0}, {0, 0.2f, 1}, b.add(lamp)));
        b.environment(sunnySky());
        if (roughness > 0) addLight(b, LightChoice::Point);
        b.add(lookAt({0.3, 0.8, 2}, {0, 0, 0.2}, 40));
        const auto scene = b.build();
        Shot shot = quickShot(30);
        shot.maxDepth = 7;
        shot.rouletteDepth = 2;
        std::atomic<int> judged{0};
        double worst = 0;
        std::optional<Render> run;
        shot.observer = [&](const PathEvent& event) {
            if (!event.technique.refracts()) return;
            const FullPath& path = event.path;
            const int depth = event.counts.rouletteDepth;
            int i = path.edges + 1 - event.technique.t;  // the eye walk's end
            Rgb walk = path.vertex[std::size_t(i)]->throughput;
            for (; i > 0; --i) {
                const auto n = std::size_t(i);
                const double pdf = path.eyePdfA[n - 1] * path.eyeRoulette(i - 1, depth);
                walk *= path.scatter[n] * float(path.geometryOf(i - 1) / pdf);
            }
            walk *= path.scatter[0] * path.sourceBeta * path.lightPdfA[0];
            const Lights& lights = run->integrator().walker().lights();
            const Rgb here = event.contribution * float(1 / event.weight);
            const double ratio = double(mean(lights.inFileUnits(walk))) / double(mean(here));
            worst = std::max(worst, std::fabs(ratio / refractedSamples(path, event.counts) - 1));
            ++judged;
        };
        run.emplace(*scene, rowNamed("pt"), shot);
        run->run();
        EXPECT_GT(judged, 500);
        EXPECT_LT(worst, 1e-3) << "roughness " << roughness;
    }
}

/// The number of samples that a path counts as depends on the path alone. The technique itself, a light subpath that
/// noted it when it was traced, and a new search agree on it. So they do where few samples are drawn, because little of
/// the light comes as far as the glass.
void expectTheSameFromAllSides(float roughness, double allowed) {
    SceneBuilder b;
    b.d.materials[0] = plastic({0.5f, 0.4f, 0.3f}, 0.6f);
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    const auto pane = b.add(glass(1.5f, roughness));
    for (const float x : {-1.2f, -0.7f, -0.2f, 0.3f, 0.8f}) {  // the middle is lit best
        b.add(box({x, 1, -1.5f}, {x + 0.4f, 1.1f, 1.5f}, pane));
    }
    addBallInABlock(b, roughness);
    b.add(quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add(emitter({2, 3, 4}))));
    b.add(quad({-2, 1.5f, 2}, {1.94f, 0, 0}, {0, 0, -4}));  // with a gap between both
    b.add(quad({0.06f, 1.5f, 2}, {1.94f, 0, 0}, {0, 0, -4}));
    b.add(lookAt({0.3, 0.8, 2}, {0, 0, 0.2}, 40));
    const auto scene = b.build();
    for (const char* name : {"pt", "bpt", "lvcbpt-merging"}) {
        Shot shot = quickShot(150);
        shot.maxDepth = 6;
        int own = 0, others = 0, few = 0;
        double worst = 0;
        shot.observer = [&](const PathEvent& event) {
            const FullPath& path = event.path;
            if (!(path.refracted.ratio > 0)) return;
            RayTally ignored;
            const RefractedLamps& lamps = *event.counts.refractedLamps;
            const double again = refractedRatioOf(path, event.counts, ignored, true).ratio;
            worst = std::max(worst, std::fabs(again / path.refracted.ratio - 1));
            ++(event.technique.refracts() ? own : others);
            few += lamps.samplesAt(path.lightsEnd(path.refracted.vertices), 1) < 1.0;
        };
        render(*scene, rowNamed(name), shot);
        EXPECT_GT(own, 300) << name;
        EXPECT_GT(others, 30) << name;
        EXPECT_GT(few, 100) << name;
        EXPECT_LT(worst, allowed) << name << ", roughness " << roughness;
    }
}
TEST(RefractedLamps, countTheSameFromAllSides) {
    expectTheSameFromAllSides(0, 1e-5);
    // A facet is computed from directions in float.
    expectTheSameFromAllSides(0.2f, 1e-3);
}

/// A lamp whose body is smooth glass, thin or solid: what a ray meets there is the lamp.
TEST(RefractedLamps, areNoGlassBeforeThemselves) {
    for (const bool solid : {false, true}) {
        SceneBuilder b;
        b.d.materials[0] = matte(Rgb(0.5f));
        b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
        lacuna::Material lamp = solid ? glass(1.2f) : pane({0.7f, 0.9f, 0.8f});
        lamp.emission = Rgb(2.0f);
        b.add(sphere({0, 0.9f, 0}, 0.5f, 12, b.add(lamp), true));
        b.add(lookAt({0.3, 1.3, 3}, {0, 0.4, 0}, 45));
        const auto scene = b.build();
        Shot shot;
        shot.iterations = 1000;
        shot.seed = 100;
        const Picture walks = render(*scene, withoutRefractions(rowNamed("pt")), shot);
        shot.seed = 1;
        for (const char* name : {"pt", "bpt"}) {
            expectSame(render(*scene, rowNamed(name), shot), walks,
                       std::string(name) + ", lamp of glass", Judge::BlocksAndMean);
        }
    }
}

/// The technique makes less noise where walks seldom run into a small lamp.
TEST(RefractedLamps, findWhatWalksMiss) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.5f));
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    b.add(box({-3, 1, -3}, {3, 1.1f, 3}, b.add(glass())));
    b.add(quad({-0.1f, 1.8f, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, b.add(emitter(Rgb(50.0f)))));
    b.add(lookAt({0.3, 0.8, 2}, {0, 0, 0.2}, 40));
    const auto scene = b.build();
    Shot shot = quickShot(200);
    shot.maxDepth = 5;
    const MethodRow pt = rowNamed("pt");
    const Picture with = render(*scene, pt, shot);
    const Picture without = render(*scene, withoutRefractions(pt), shot);
    EXPECT_LT(with.standardError(), 0.2 * without.standardError());
}

}  // namespace
}  // namespace lacuna::test
