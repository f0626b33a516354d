// Light of lamps without a size that no connection can make: it comes over mirrors or through smooth glass, and is seen
// over mirrors or through smooth glass. (theory.md, "Specular chains")
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <span>

#include "libcore/bidir/verify.h"
#include "libcore/material/fresnel.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

class SpecularChainsOf : public RowTest {};
INSTANTIATE_TEST_SUITE_P(All, SpecularChainsOf,
                         testing::ValuesIn(rowNamesWith(&Techniques::searchForChains,
                                                        Rows::OfTheTool)),
                         ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, SpecularChainsOf,
                         testing::ValuesIn(rowNamesWith(&Techniques::searchForChains,
                                                        Rows::OfTests)),
                         ByParameter());

/// How far to the side a ray comes through slabs and air, by the sine of its angle to the vertical.
struct Stack {
    double air, glass, index;
    double across(double sine) const {
        const double inside = sine / index;
        return air * sine / std::sqrt(1 - sine * sine) +
               glass * inside / std::sqrt(1 - inside * inside);
    }
    /// The sine of the ray that comes that far.
    double sineOf(double distance) const {
        double low = 0, high = 1;
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            (across(middle) < distance ? low : high) = middle;
        }
        return 0.5 * (low + high);
    }
};

/// What both faces of a slab let through.
double throughSlab(double sine) {
    const double f = fresnelDielectric(std::sqrt(1 - sine * sine), 1.5);
    return (1 - f) * (1 - f);
}

struct Lamp {
    Vec3d position;
    double intensity;
};

/// Lamps and a camera above a slab of glass, a floor below it, both of them `reach` wide to each side.
void expectLampsBySlab(const MethodRow& row, std::span<const Lamp> lamps, float reach,
                       int iterations) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(quad({-reach, 0, reach}, {2 * reach, 0, 0}, {0, 0, -2 * reach}));
    const auto clear = b.add(glass());
    b.add(box({-reach, 1, -reach}, {reach, 1.5f, reach}, clear));
    for (const Lamp& lamp : lamps) {
        b.add(pointLight(lamp.position, Rgb(float(lamp.intensity))));
    }
    b.add(lookAt({0.3, 1.8, 2}, {0, 0, 0.2}, 40));
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 6;  // no reflections inside
    shot.iterations = iterations;
    shot.lightPaths = 1024;
    const Camera camera = scene->makeCamera("", {shot.width, shot.height}, {});
    const Vec3d from = Vec3d(camera.position()) + scene->centre();
    const Stack toEye{from.y - 0.5, 0.5, 1.5};
    const std::vector<Rgb> exact = meanOverPixels(camera, shot, [&](Vec3d d) {
        const double eyeSine = std::hypot(d.x, d.z);
        const double shift = toEye.across(eyeSine) / eyeSine;
        const Vec3d point{from.x + d.x * shift, 0, from.z + d.z * shift};
        double irradiance = 0;
        for (const auto& [lamp, intensity] : lamps) {
            const Stack toLamp{lamp.y - 0.5, 0.5, 1.5};
            const double distance = std::hypot(lamp.x - point.x, lamp.z - point.z);
            const double sine = toLamp.sineOf(distance);
            // The power of a ring of directions falls on the ring of the floor that it reaches.
            const double by = 1e-6;
            const double ring = (toLamp.across(sine + by) - toLamp.across(sine - by)) / (2 * by);
            const double cosine = std::sqrt(1 - sine * sine);
            irradiance += intensity * throughSlab(sine) * sine / (cosine * distance * ring);
        }
        const double radiance = irradiance * throughSlab(eyeSine) * 0.6 / std::numbers::pi;
        return Vec3d{radiance, radiance, radiance};
    });
    expectRadiance(render(*scene, row, shot), exact, row.name + ", lamps and slab",
                   Judge::BlocksAndMean);
}

TEST_P(SpecularChainsOf, pointLightThroughSolidGlassSeenThroughSolidGlass) {
    const Lamp lamp{{0.2, 2.0, 0}, 2};
    expectLampsBySlab(row(), {&lamp, 1}, 30, 400);
}

/// The known ways draw a dim lamp nearby more often than its power would.
TEST(SpecularChains, ofADimLampNearbyAndABrightOneFarAway) {
    const Lamp lamps[] = {{{0.2, 2.0, 0}, 0.5}, {{4, 2.5, -3}, 3}};
    expectLampsBySlab(rowNamed("pt"), lamps, 8, 1600);
}

/// A mirror lights a floor with the sun, and another mirror shows the floor. In the reference the sun's image stands in
/// for the first mirror.
TEST_P(SpecularChainsOf, sunInAMirrorSeenInAMirror) {
    const Vec3d way{1.0, -0.8, 0};
    const double reflected = 0.8 + 0.2 * std::pow(1 - normalize(way).x, 5);
    const auto stage = [&](bool mirrored) {
        SceneBuilder b;
        b.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
        b.add(quad({-9, 0, -3}, {18, 0, 0}, {0, 9, 0}, b.add(mirror(Rgb(0.9f)))));
        // A wall keeps the sun off the floor, except by way of the mirror opposite.
        b.add(quad({-1.5f, 0, 2}, {0, 3, 0}, {0, 0, -4}));
        if (mirrored) b.add(quad({3, 0, 9}, {0, 9, 0}, {0, 0, -18}, b.add(mirror(Rgb(0.8f)))));
        b.add(directionalLight({mirrored ? way.x : -way.x, way.y, way.z},
                               Rgb(float(mirrored ? 3.0 : 3.0 * reflected))));
        b.add(lookAt({0, 0.6f, 3}, {0, 0.2f, -3}, 0.8));
        return b.build();
    };
    Shot shot;
    shot.iterations = 400;
    shot.lightPaths = 1024;
    shot.maxDepth = 3;
    static const Picture image = render(*stage(false), rowNamed("pt"), shot);
    shot.maxDepth = 4;
    expectSame(render(*stage(true), row(), shot), image, row().name + ", sun in mirrors");
}

/// From its middle, light leaves a ball as if there were no glass: what is reflected inside comes back and is refracted
/// out on the other side. This holds however often chains are searched for.
TEST(SpecularChains, aBallAboutALampTakesNothingAway) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(quad({-30, 0, 30}, {60, 0, 0}, {0, 0, -60}));
    const Vec3d lamp{0.1, 1.5, 0.2};
    b.add(sphere(Vec3(lamp), 0.4f, 24, b.add(glass()), true));
    b.add(pointLight(lamp, Rgb(2.0f)));
    b.add(lookAt({0.3, 1.0, 3}, {0, 0, 0.2}, 25));
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 6;
    shot.iterations = 400;
    const Camera camera = scene->makeCamera("", {shot.width, shot.height}, {});
    const Vec3d from = Vec3d(camera.position()) + scene->centre();
    const double inside = std::pow(fresnelDielectric(1.0, 1.5), 4);  // beyond six edges
    const std::vector<Rgb> exact = meanOverPixels(camera, shot, [&](Vec3d d) {
        const Vec3d toLamp = lamp - (from - d * (from.y / d.y));
        const double distance = length(toLamp);
        const double irradiance = 2 * (toLamp.y / distance) / (distance * distance);
        const double radiance = irradiance * (1 - inside) * 0.6 / std::numbers::pi;
        return Vec3d{radiance, radiance, radiance};
    });
    for (const double effort : {0.5, 1.0, 2.0}) {
        shot.glassEffort.chains = effort;
        expectRadiance(render(*scene, rowNamed("pt"), shot), exact,
                       "pt, lamp in a ball, effort " + std::to_string(effort),
                       Judge::BlocksAndMean);
    }
}

/// Caustics that the camera sees directly: splats make them, and chains do in a path tracer. The things hardly focus,
/// because few samples hold most of a sharp caustic. The mirror is a fine mesh, since coarse ones draw bright lines.
class Caustics : public testing::TestWithParam<LightChoice> {};
std::string nameOfLight(const testing::TestParamInfo<LightChoice>& test) {
    return testName(nameOf(test.param));
}
INSTANTIATE_TEST_SUITE_P(Day, Caustics, testing::Values(LightChoice::Point), nameOfLight);
INSTANTIATE_TEST_SUITE_P(Night, Caustics,
                         testing::Values(LightChoice::Spot, LightChoice::Directional), nameOfLight);

SceneBuilder specularStage(LightChoice light) {
    SceneBuilder b;
    b.d.materials[0] = matte({0.5f, 0.4f, 0.3f});
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    b.add(
        sphere({-0.7f, 0.5f, 0}, 0.4f, 24, b.add(colouredGlass({0.2f, 0.5f, 0.1f}, 1.05f)), true));
    b.add(sphere({0.7f, 0.5f, 0.2f}, 0.35f, 24, b.add(mirror({0.9f, 0.6f, 0.3f})), true));
    // A smooth coat over a colour, and a sheet that is thin and bent.
    b.add(sphere({0, 0.4f, 0.7f}, 0.3f, 12, b.add(plastic({0.3f, 0.2f, 0.6f}, 0)), true));
    b.add(sphere({0, 0.6f, -0.7f}, 0.4f, 12, b.add(pane({0.7f, 0.9f, 0.8f})), true));
    lacuna::Material bumpy = glass(1.2f);
    bumpy.normalTexture = b.add(waves());
    bumpy.normalScale = 0.2f;
    const auto tile = b.add(box({-0.4f, 1.5f, -0.4f}, {0.4f, 1.6f, 0.4f}, b.add(bumpy)),
                            translation({0.2, 0, 0}) * rotation({1, 0, 1}, 20));
    b.instance(tile, translation({-1, 0.2, 0.8}) * scaling({1.2, 0.8, -0.7}));
    addLight(b, light);
    b.add(lookAt({0.3, 1.6, 3}, {0, 0.2, 0}, 45));
    return b;
}

void expectChainsAsSplats(const SceneBuilder& b, int maxDepth, int iterations, int iterationsOfPt,
                          const std::string& what) {
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = maxDepth;
    shot.iterations = iterations;
    const Picture splats = render(*scene, rowNamed("bpt"), shot);
    shot.seed = 2;
    shot.iterations = iterationsOfPt;
    expectSame(render(*scene, rowNamed("pt"), shot), splats, what, Judge::BlocksAndMean);
}

TEST_P(Caustics, areTheSameByChainsAndBySplats) {
    // Paths have no more edges than the longest chains. Few samples hold the light of ways that no ray from the light
    // came by: after 3000 iterations of pt blocks were too dark by up to 8 of their own errors, and after 18,000 none
    // was.
    expectChainsAsSplats(specularStage(GetParam()), 6, 3000, 18000,
                         nameOf(GetParam()) + ", caustics");
}

/// Mirrors with a little relief under flat lacquer, and flat mirrors under lacquer with a relief: each shows two images
/// of the lamp.
TEST_P(Caustics, ofLacquerAreTheSameByChainsAndBySplats) {
    SceneBuilder b;
    b.d.materials[0] = matte({0.5f, 0.4f, 0.3f});
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    const TextureUse relief = b.add(waves());
    lacuna::Material lacquer = mirror({0.3f, 0.4f, 0.5f});
    lacquer.clearcoat = 1.0f;
    lacquer.normalTexture = relief;
    lacquer.normalScale = 0.1f;
    b.add(box({-1, 0, -0.4f}, {-0.4f, 0.7f, 0.2f}, b.add(lacquer)), rotation({0, 1, 0}, 25));
    lacquer.normalTexture = {};
    lacquer.clearcoatNormalTexture = relief;
    lacquer.clearcoatNormalScale = 0.1f;
    b.add(box({0.4f, 0, -0.4f}, {1, 0.7f, 0.2f}, b.add(lacquer)), rotation({0, 1, 0}, -25));
    addLight(b, GetParam());
    b.add(lookAt({0.3, 1.6, 3}, {0, 0.2, 0}, 45));
    expectChainsAsSplats(b, 4, 2000, 2000, nameOf(GetParam()) + ", lacquer");
}

/// A mirror that alpha leaves half of, and a coloured window that reflects a little: rays meet either only at random.
TEST_P(Caustics, ofHalfAMirrorAndAWindowAreTheSameByChainsAndBySplats) {
    SceneBuilder b;
    b.d.materials[0] = matte({0.5f, 0.4f, 0.3f});
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    lacuna::Material half = mirror({0.8f, 0.6f, 0.3f});
    half.alphaMode = lacuna::Material::Alpha::Blend;
    half.baseAlpha = 0.5f;
    b.add(quad({-2, 0, -1}, {4, 0, 0}, {0, 3, 0}, b.add(half)));
    b.add(quad({-1.5f, 0, -2}, {0, 0, 4}, {0, 3, 0}, b.add(pane({0.9f, 0.4f, 0.6f}))));
    addLight(b, GetParam());
    b.add(lookAt({0.3, 1.6, 3}, {0, 0.2, 0}, 45));
    expectChainsAsSplats(b, 4, 2000, 2000, nameOf(GetParam()) + ", alpha and a pane");
}

/// A chain's path has no other technique in any row: its weight by products is one.
TEST_P(SpecularChainsOf, makeWhatNothingElseMakes) {
    const auto scene = specularStage(LightChoice::Point).build();
    Shot shot = quickShot(150);
    shot.maxDepth = 8;
    std::atomic<int> chains{0}, meeting{0};
    std::optional<Render> run;
    shot.observer = [&](const PathEvent& event) {
        if (!event.technique.chains()) return;
        ++chains;
        EXPECT_EQ(event.weight, 1.0);
        const auto weightOf = [&](const FullPath& path) {
            return misWeightByProducts(run->integrator().walker(), path, event.counts,
                                       event.technique);
        };
        EXPECT_EQ(weightOf(event.path), 1.0);
        EXPECT_FALSE(event.path.hittable);
        // At the edge of a body a ray goes in and out at one point: there, too, the weight must be one.
        for (int i = 1; i + 1 < event.path.edges; ++i) {
            if (!event.path.delta[i] || !event.path.delta[i + 1]) continue;
            ++meeting;
            FullPath path = event.path;
            PathVertex moved = *path.vertex[i + 1];
            moved.position = path.vertex[i]->position;
            path.vertex[i + 1] = &moved;
            EXPECT_EQ(weightOf(path), 1.0);
        }
    };
    run.emplace(*scene, row(), shot);
    run->run();
    EXPECT_GT(chains, 50);
    EXPECT_GT(meeting, 10);
}

}  // namespace
}  // namespace lacuna::test
