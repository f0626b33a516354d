// Acceptance 5: scenes whose radiance is known without a reference.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

class Exact : public RowTest {};
INSTANTIATE_TEST_SUITE_P(All, Exact, testing::ValuesIn(rowNames(Rows::OfTheTool)), ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, Exact, testing::ValuesIn(rowNames(Rows::OfTests)), ByParameter());

/// A closed room with things in it. Every surface has albedo a and emission 1 - a, so that the radiance is 1 - a^depth
/// if paths end after `depth` edges.
SceneBuilder furnace(float albedo) {
    SceneBuilder b;
    b.d.materials[0] = emitter(Rgb(1 - albedo), false, Rgb(albedo));
    b.add(box({-1, -1, -1}, {1, 1, 1}, 0, true));
    b.add(box({-0.7f, -0.99f, -0.6f}, {-0.3f, -0.2f, -0.2f}));
    const auto mesh = b.add(box({-0.2f, -0.3f, -0.2f}, {0.2f, 0.3f, 0.2f}),
                            translation({0.4, -0.2, -0.3}) * rotation({1, 2, 3}, 50));
    b.instance(mesh,
               translation({0.1, 0.5, -0.4}) * rotation({0, 1, 1}, 70) * scaling({1, -0.5, 1}));
    b.add(lookAt({0, 0, 0.9}, {0, 0, -1}, 70));
    return b;
}

TEST_P(Exact, furnaceIsOneEverywhereAndAtTheBorder) {
    const auto scene = furnace(0.5f).build();
    Shot shot;
    shot.maxDepth = 5;
    shot.iterations = 150;
    const Picture p = render(*scene, row(), shot);
    const double exact = 1 - std::pow(0.5, shot.maxDepth);
    expectRadiance(p, exact, row().name + ", furnace");

    // The film's border and its interior, each by itself: filters and splats must agree on where the film ends.
    Moments border, inside;
    const Image image = p.pixels.image();
    for (int y = 0; y < shot.height; ++y) {
        for (int x = 0; x < shot.width; ++x) {
            const bool edge = x == 0 || y == 0 || x == shot.width - 1 || y == shot.height - 1;
            (edge ? border : inside).add(mean(image.at(x, y)));
        }
    }
    EXPECT_NEAR(border.mean(), exact, 5 * border.standardError() + 1e-5);
    EXPECT_NEAR(inside.mean(), exact, 5 * inside.standardError() + 1e-5);
    stabilityCase("film-border", worstDeviation(), kOfAllowed);
}

/// Leaves reflect or transmit half of the light, and emit the other half on both sides: a box of them glows inside as
/// it does outside.
TEST_P(Exact, furnaceOfLeaves) {
    SceneBuilder b = furnace(0.5f);
    lacuna::Material leaf = emitter(Rgb(0.5f), true, Rgb(0.5f));
    leaf.diffuseTransmission = 0.4f;
    leaf.diffuseTransmissionColor = Rgb(0.5f);
    const auto leaves = b.add(leaf);
    b.add(box({0.3f, -0.6f, -0.6f}, {0.7f, 0.1f, -0.1f}, leaves));
    b.add(quad({-0.5f, 0.2f, 0.2f}, {0.5f, 0.1f, 0}, {0, 0.3f, 0.1f}, leaves));
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 5;
    shot.iterations = 150;
    expectRadiance(render(*scene, row(), shot), 1 - std::pow(0.5, shot.maxDepth),
                   row().name + ", furnace of leaves");
}

// Direct light on a plane
// --------------------------------------------------------------------------

/// Irradiance on the plane y = 0 at (x, z).
using Irradiance = std::function<double(double x, double z)>;

/// Compares a floor of albedo 0.6, lit only by what `light` adds, with the closed form.
void expectFloor(const MethodRow& row, const std::function<void(SceneBuilder&)>& light,
                 const Irradiance& irradiance, const std::string& what,
                 Judge judge = Judge::Everything) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}));
    b.add(lookAt({0.3, 1.5, 2}, {0, 0, 0.2}, 40));
    light(b);
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 2;
    shot.iterations = 200;
    shot.lightPaths = 1024;
    const Camera camera = scene->makeCamera("", {shot.width, shot.height}, {});
    const Vec3d from = Vec3d(camera.position()) + scene->centre();
    const std::vector<Rgb> exact = meanOverPixels(camera, shot, [&](Vec3d d) {
        const double e = irradiance(from.x - d.x * from.y / d.y, from.z - d.z * from.y / d.y);
        return Vec3d{e, e, e} * (0.6 / std::numbers::pi);
    });
    expectRadiance(render(*scene, row, shot), exact, row.name + ", " + what, judge);
}

/// The floor is paper, and the sun below it.
TEST_P(Exact, sunShinesThroughPaper) {
    const double cosine = 0.8;
    expectFloor(
        row(),
        [&](SceneBuilder& b) {
            lacuna::Material& paper = b.d.materials[0];
            paper.baseColor = Rgb(0.9f);
            paper.diffuseTransmission = 0.5f;
            b.add(directionalLight({0.6, cosine, 0}, Rgb(3.0f)));
        },
        // This floor lets half of the light through; expectFloor() multiplies by an albedo of 0.6.
        [&](double, double) { return 3 * cosine * 0.5 / 0.6; }, "sun through paper");
}

/// The form factor of a rectangle [0, a] x [0, b] at distance 1, seen from below its corner at the origin.
double cornerFormFactor(double a, double b) {
    const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
    return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * std::numbers::pi);
}

TEST_P(Exact, quadLightHasItsFormFactor) {
    const double y = 1.8, x0 = -0.6, x1 = 0.4, z0 = -0.3, z1 = 0.3, radiance = 2;
    for (const bool twoSided : {false, true}) {
        expectFloor(
            row(),
            [&](SceneBuilder& b) {
                b.add(quad({float(x0), float(y), float(z0)}, {float(x1 - x0), 0, 0},
                           {0, 0, float(z1 - z0)}, b.add(emitter(Rgb(float(radiance)), twoSided))));
            },
            [&](double x, double z) {
                const auto f = [&](double u, double v) {
                    return cornerFormFactor((u - x) / y, (v - z) / y);
                };
                const double factor = f(x1, z1) - f(x0, z1) - f(x1, z0) + f(x0, z0);
                return std::numbers::pi * radiance * factor;
            },
            twoSided ? "two-sided quad" : "quad");
    }
}

/// A lamp emits what its alpha leaves of it: a share under BLEND, the part that is kept under MASK.
TEST_P(Exact, lampsWithAlphaHaveTheirShare) {
    using Alpha = lacuna::Material::Alpha;
    const double y = 1.8, x0 = -0.6, x1 = 0.4, z0 = -0.3, z1 = 0.3, radiance = 2;
    Texture right;  // alpha is 0 on the left half, 3/4 on the right one
    right.width = 64;
    right.height = 1;
    right.wrapU = right.wrapV = Texture::Wrap::ClampToEdge;
    for (int i = 0; i < 64; ++i) {
        const std::uint8_t texel[] = {255, 255, 255, std::uint8_t(i < 32 ? 0 : 191)};
        right.rgba.insert(right.rgba.end(), texel, texel + 4);
    }
    struct Lamp {
        const char* name;
        Alpha mode;
        float alpha;
        bool textured;
        double left, share;  ///< where the lamp begins, and how much of the rest is there
    };
    const double middle = 0.5 * (x0 + x1);
    for (const Lamp& lamp :
         {Lamp{"blend", Alpha::Blend, 0.3f, false, x0, 0.3},
          Lamp{"mask above its cutoff", Alpha::Mask, 0.6f, false, x0, 1},
          Lamp{"mask below its cutoff", Alpha::Mask, 0.4f, false, x1, 1},
          Lamp{"blend by a texture", Alpha::Blend, 0.4f, true, middle, 0.4 * 191 / 255},
          Lamp{"mask by a texture", Alpha::Mask, 1, true, middle, 1}}) {
        expectFloor(
            row(),
            [&](SceneBuilder& b) {
                lacuna::Material m = emitter(Rgb(float(radiance)));
                m.alphaMode = lamp.mode;
                m.baseAlpha = lamp.alpha;
                // The lamp begins where the interpolated texels are halfway up.
                if (lamp.textured) m.alphaCutoff = 0.5f * 191 / 255;
                if (lamp.textured) m.baseColorTexture = m.emissiveTexture = b.add(right);
                b.add(quad({float(x0), float(y), float(z0)}, {float(x1 - x0), 0, 0},
                           {0, 0, float(z1 - z0)}, b.add(m)));
            },
            [&](double x, double z) {
                const auto f = [&](double u, double v) {
                    return cornerFormFactor((u - x) / y, (v - z) / y);
                };
                const double left = lamp.left;
                const double factor = f(x1, z1) - f(left, z1) - f(x1, z0) + f(left, z0);
                return std::numbers::pi * radiance * lamp.share * factor;
            },
            lamp.name);
    }
    stabilityCase("lamps-with-alpha", worstDeviation(), kOfAllowed);
}

/// A strip of light lies close behind the slit, so that the floor sees light in all of the slit and nowhere else.
TEST_P(Exact, lightThroughAGapOfAThousandth) {
    const double y = 1.8, half = 0.5e-3, radiance = 100;
    expectFloor(
        row(),
        [&](SceneBuilder& b) {
            const auto black = b.add(matte(Rgb(0.0f)));
            const auto h = float(half), yf = float(y);
            b.add(quad({-2, yf, -3}, {2 - h, 0, 0}, {0, 0, 6}, black));
            b.add(quad({h, yf, -3}, {2 - h, 0, 0}, {0, 0, 6}, black));
            b.add(quad({-h, yf, -3}, {2 * h, 0, 0}, {0, 0, 2}, black));
            b.add(quad({-h, yf, 1}, {2 * h, 0, 0}, {0, 0, 2}, black));
            b.add(quad({-3e-3f, yf + 4e-3f, -1.1f}, {6e-3f, 0, 0}, {0, 0, 2.2f},
                       b.add(emitter(Rgb(float(radiance))))));
        },
        [&](double x, double z) {
            const auto f = [&](double u, double v) {
                return cornerFormFactor((u - x) / y, (v - z) / y);
            };
            return std::numbers::pi * radiance *
                   (f(half, 1) - f(-half, 1) - f(half, -1) + f(-half, -1));
        },
        "gap of a thousandth", Judge::MeanOnly);
    stabilityCase("thin-gap", worstDeviation(), kOfAllowed);
}

TEST_P(Exact, pointLightFollowsTheInverseSquare) {
    const Vec3d p{-0.4, 1.3, 0.3};
    expectFloor(
        row(), [&](SceneBuilder& b) { b.add(pointLight(p, Rgb(3.0f))); },
        [&](double x, double z) {
            const double d2 = lengthSquared(p - Vec3d{x, 0, z});
            return 3 * p.y / std::sqrt(d2) / d2;
        },
        "point light");
}

TEST_P(Exact, spotLightHasItsFalloff) {
    const Vec3d p{0.3, 1.6, 0.6}, axis = normalize(Vec3d{-0.2, -1, -0.3});
    const double inner = 0.3, outer = 0.8;
    expectFloor(
        row(), [&](SceneBuilder& b) { b.add(spotLight(p, axis, Rgb(4.0f), inner, outer)); },
        [&](double x, double z) {
            const Vec3d d = Vec3d{x, 0, z} - p;
            const double distance = length(d), cosine = dot(d, axis) / distance;
            const double ramp = (cosine - std::cos(outer)) / (std::cos(inner) - std::cos(outer));
            const double falloff = std::clamp(ramp, 0.0, 1.0);
            return 4 * falloff * falloff * p.y / (distance * distance * distance);
        },
        "spot light");
}

TEST_P(Exact, directionalLightFollowsTheCosine) {
    const Vec3d d = normalize(Vec3d{0.3, -1, -0.7});
    expectFloor(
        row(), [&](SceneBuilder& b) { b.add(directionalLight(d, Rgb(1.5f))); },
        [&](double, double) { return 1.5 * -d.y; }, "directional light");
}

// A constant environment
// ---------------------------------------------------------------------------

TEST_P(Exact, emptySceneShowsItsEnvironment) {
    SceneBuilder b;
    b.environment(constantSky(1));
    b.add(lookAt({0, 0, 0}, {0, 0.3, -1}, 60));
    Shot shot;
    shot.iterations = 100;
    shot.lightPaths = 1024;
    expectRadiance(render(*b.build(), row(), shot), 1, row().name + ", environment alone");
    stabilityCase("sky-alone", worstDeviation(), kOfAllowed);
}

TEST_P(Exact, convexBodyUnderAConstantSkyShowsItsAlbedo) {
    SceneBuilder b;
    b.add(sphere({0, 0, 0}, 1, 16, 0));  // flat facets: no facet sees another one
    b.environment(constantSky(1));
    b.add(lookAt({0, 0.5, 4}, {0, 0, 0}, 16));
    Shot shot;
    shot.iterations = 200;
    shot.lightPaths = 1024;
    expectRadiance(render(*b.build(), row(), shot), 0.5, row().name + ", sphere under the sky");
    stabilityCase("sky-alone", worstDeviation(), kOfAllowed);
}

/// Veils of alpha 0.25 and 0.5 that reflect nothing, between the camera and a light that fills its
/// view: 0.75 x 0.5 of the light gets through.
TEST_P(Exact, veilsLetTheirShareThrough) {
    SceneBuilder b;
    b.add(quad({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, b.add(emitter(Rgb(2.0f)))));
    for (const float alpha : {0.25f, 0.5f}) {
        lacuna::Material veil = matte(Rgb(0.0f));
        veil.alphaMode = lacuna::Material::Alpha::Blend;
        veil.baseAlpha = alpha;
        b.add(quad({-9, -9, -1 - alpha}, {18, 0, 0}, {0, 18, 0}, b.add(veil)));
    }
    b.add(lookAt({0, 0, 0}, {0, 0, -1}, 40));
    Shot shot;
    shot.maxDepth = 2;
    shot.iterations = 300;
    expectRadiance(render(*b.build(), row(), withSplatsForEveryPixel(shot, row())), 0.75,
                   row().name + ", veils");
}

/// A slab of ior 1, half a unit thick, between the camera and a light that fills its view.
TEST_P(Exact, colouredGlassFollowsBeerAndLambert) {
    if (!seesThroughDeltas(row())) return;
    const Rgb absorption(0.5f, 2, 0);
    SceneBuilder b;
    b.add(quad({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, b.add(emitter(Rgb(2.0f)))));
    b.add(box({-5, -5, -1.5f}, {5, 5, -1}, b.add(colouredGlass(absorption, 1))));
    b.add(lookAt({0, 0, 0}, {0, 0, -1}, 60));
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 3;
    shot.iterations = 100;
    const Camera camera = scene->makeCamera("", {shot.width, shot.height}, {});
    const std::vector<Rgb> exact = meanOverPixels(camera, shot, [&](Vec3d d) {
        const double inside = 0.5 / std::fabs(d.z);
        return Vec3d{std::exp(-absorption.r * inside), std::exp(-absorption.g * inside), 1} * 2.0;
    });
    expectRadiance(render(*scene, row(), shot), exact, row().name + ", coloured slab");
}

/// The sky dims as the scene grows, so that its power stays the same, and so does whatever a density makes of beta.
/// Shot::gain undoes the dimming.
SceneBuilder sphereOnGround(double scale, Vec3d offset) {
    SceneBuilder b;
    const Affine place = translation(offset) * scaling({scale, scale, scale});
    b.add(sphere({0, 0.5f, 0}, 0.5f, 16, b.add(plastic({0.6f, 0.3f, 0.2f}, 0.5f)), true), place);
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), place);
    b.environment(sunnySky(), 1 / (scale * scale));
    b.add(lookAt(place.point({0, 2.6, 1.6}), place.point({0, 0.3, 0}), 30));
    return b;
}

TEST_P(Exact, sizeAndPlaceChangeNothingUnderTheSky) {
    Shot shot;
    shot.iterations = 150;
    shot.maxDepth = 3;
    shot.lightPaths = 1024;
    const Picture& there = reference(sphereOnGround(1, {}), shot);
    shot.seed = 2;
    shot.gain = 1e6f;
    // In the sphere's shadow a few splats bring most of the light: blocks are compared, not pixels.
    expectSame(render(*sphereOnGround(1000, {}).build(), row(), shot), there,
               row().name + ", 1000 times as large", Judge::BlocksAndMean);
    shot.gain = 1;
    expectSame(render(*sphereOnGround(1, {1e5, -1e5, 1e5}).build(), row(), shot), there,
               row().name + ", 1e5 away", Judge::BlocksAndMean);
    stabilityCase("scale", worstDeviation(), kOfAllowed);
    stabilityCase("offset", worstDeviation(), kOfAllowed);
}

// Lossless glass fills the picture. Only hits of the environment make these paths, and all of them bring the same
// radiance. So there is no noise, and a lost factor shows in each pixel.

void expectSmoothRadiance(const MethodRow& row, SceneBuilder b, double exact,
                          const std::string& what) {
    if (!seesThroughDeltas(row)) return;
    b.environment(constantSky(1));
    const auto scene = b.build();
    Shot shot;
    shot.maxDepth = 100;
    shot.iterations = 4;
    shot.width = shot.height = 8;
    expectRadiance(render(*scene, row, shot), exact, row.name + ", " + what);
}

TEST_P(Exact, losslessGlassInAConstantEnvironmentReadsOne) {
    SceneBuilder solid;
    solid.add(sphere({0, 0, 0}, 1, 16, solid.add(glass())));
    solid.add(lookAt({0, 0.5, 4}, {0, 0, 0}, 16));
    expectSmoothRadiance(row(), solid, 1, "solid glass");

    // With smooth normals the facets are no panes; through panes connections would join the sky with the lens.
    SceneBuilder thin;
    thin.add(sphere({0, 0, 0}, 1, 16, thin.add(pane()), true));
    thin.add(lookAt({0, 0.5, 4}, {0, 0, 0}, 16));
    expectSmoothRadiance(row(), thin, 1, "thin glass");

    // Glass in glass: in our model the inner surface is a body of ior 1.2 with air outside.
    SceneBuilder nested;
    nested.add(sphere({0, 0, 0}, 1, 16, nested.add(glass())));
    nested.add(sphere({0.1f, 0, 0.1f}, 0.5f, 16, nested.add(glass(1.2f))));
    nested.add(lookAt({0, 0.5, 4}, {0, 0, 0}, 16));
    expectSmoothRadiance(row(), nested, 1, "glass in glass");
    stabilityCase("refraction", worstDeviation(), kOfAllowed);
}

TEST_P(Exact, insideGlassTheSkyReadsTheSquaredIndex) {
    SceneBuilder b;
    b.add(sphere({0, 0, 0}, 1, 16, b.add(glass())));
    b.add(lookAt({0, 0, 0}, {0.2, 0.3, -1}, 60));  // from the middle nothing is trapped
    expectSmoothRadiance(row(), b, 2.25, "inside glass");
    stabilityCase("refraction", worstDeviation(), kOfAllowed);
}

}  // namespace
}  // namespace lacuna::test
