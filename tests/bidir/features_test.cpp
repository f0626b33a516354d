// The layers albedo, normal, Z and position: what they show over mirrors and through glass.
#include "libcore/bidir/features.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

FeatureLayers layersOf(const SceneBuilder& b, int side = 8) {
    const auto scene = b.build();
    const Camera camera = scene->makeCamera("", {side, side}, {});
    return renderFeatures(*scene, camera, {0, side, 0, side}, 1, pool());
}

void expectNear(const Rgb& value, const Rgb& expected, float error = 1e-4f) {
    EXPECT_NEAR(value.r, expected.r, error);
    EXPECT_NEAR(value.g, expected.g, error);
    EXPECT_NEAR(value.b, expected.b, error);
}

/// A large square at this z. Its front is towards +z, or towards -z if it is `turned`.
Mesh wall(float z, std::uint32_t material, bool turned = false) {
    return turned ? quad({-50, -50, z}, {0, 100, 0}, {100, 0, 0}, material)
                  : quad({-50, -50, z}, {100, 0, 0}, {0, 100, 0}, material);
}

const Rgb kBehind(0.8f, 0.2f, 0.1f), kBefore(0.1f, 0.6f, 0.3f);

TEST(Features, AreOfWhatAMirrorShows) {
    SceneBuilder b;
    const Rgb gold(1.0f, 0.8f, 0.3f);
    b.add(wall(-2, b.add(mirror(gold))));
    b.add(wall(3, b.add(matte(kBefore)), true));
    b.add(lookAt({0, 0, 1}, {0, 0, 0}, 1));
    const FeatureLayers layers = layersOf(b);
    for (std::size_t i = 0; i < layers.z.size(); ++i) {
        expectNear(layers.albedo.pixels[i], gold * kBefore, 1e-3f);
        expectNear(layers.normal.pixels[i], {0, 0, -1});
        EXPECT_NEAR(layers.z[i], 3, 1e-4f);  // the mirror's own
        EXPECT_NEAR(layers.position[i].z, -2, 1e-4f);
    }
}

/// 4 % are reflected at either side of a slab, and what is reflected within is white.
TEST(Features, BlendByFresnelAtGlass) {
    SceneBuilder b;
    b.add(box({-60, -60, -1}, {60, 60, 0}, b.add(glass(1.5f))));
    b.add(wall(-3, b.add(matte(kBehind))));
    b.add(wall(4, b.add(matte(kBefore)), true));
    b.add(lookAt({0, 0, 1}, {0, 0, 0}, 1));
    const FeatureLayers layers = layersOf(b);
    const float f = 0.04f;
    for (std::size_t i = 0; i < layers.z.size(); ++i) {
        expectNear(layers.albedo.pixels[i],
                   f * kBefore + (1 - f) * (1 - f) * kBehind + Rgb((1 - f) * f), 1e-3f);
        EXPECT_NEAR(layers.normal.pixels[i].b, (1 - f) * (1 - f) - f - (1 - f) * f, 1e-3f);
        EXPECT_NEAR(layers.z[i], 1, 1e-4f);
    }
}

TEST(Features, KnowWhatColouredGlassTakes) {
    SceneBuilder b;
    const Rgb sigma(0.5f, 0.1f, 2.0f);
    b.add(box({-60, -60, -1.5f}, {60, 60, 0}, b.add(colouredGlass(sigma, 1.0f))));
    b.add(wall(-3, b.add(matte(kBehind))));
    b.add(lookAt({0, 0, 1}, {0, 0, 0}, 1));
    const FeatureLayers layers = layersOf(b);
    const Rgb left(std::exp(-0.75f), std::exp(-0.15f), std::exp(-3.0f));
    for (const Rgb& albedo : layers.albedo.pixels) expectNear(albedo, left * kBehind, 1e-3f);
}

/// Between mirrors that show each other for ever.
TEST(Features, EndWhereNothingElseIsSeen) {
    SceneBuilder b;
    b.add(box({-1, -1, -1}, {1, 1, 1}, b.add(mirror(Rgb(0.9f))), true));
    b.add(lookAt({0.2, 0.1, 0.5}, {-0.3, 0.2, 0}, 60));
    const FeatureLayers layers = layersOf(b, 16);
    for (std::size_t i = 0; i < layers.z.size(); ++i) {
        const Rgb& albedo = layers.albedo.pixels[i];
        EXPECT_GT(albedo.r, 0.3f);
        EXPECT_LT(albedo.r, 0.9f);
    }
}

/// Where a ray meets nothing, every layer is zero. Where a mirror shows nothing, albedo and normal
/// are zero as well.
TEST(Features, AreZeroWhereNothingIs) {
    SceneBuilder b;
    b.add(quad({-50, -50, -2}, {50, 0, 0}, {0, 100, 0}, b.add(mirror())));
    b.add(lookAt({0, 0, 1}, {0, 0, 0}, 40));
    const FeatureLayers layers = layersOf(b);
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
            const auto i = std::size_t(y * 8 + x);
            EXPECT_EQ(layers.albedo.pixels[i], Rgb());
            EXPECT_EQ(layers.normal.pixels[i], Rgb());
            EXPECT_EQ(layers.z[i] > 0, x < 4);
            EXPECT_EQ(layers.position[i] == Vec3(), x >= 4);
        }
    }
}

/// The ranges that Open Image Denoise asks for, with every kind of lobe in view.
TEST(Features, LieInTheRangesOfDenoisers) {
    SceneBuilder b;
    lacuna::Material shiny = plastic(Rgb(1.0f), 0.3f);
    shiny.specularColor = Rgb(1.0f, 5.0f, 0.2f);
    shiny.clearcoat = 1;
    lacuna::Material bumpy = mirror();
    bumpy.normalTexture = b.add(waves());
    b.add(wall(-4, b.add(shiny)));
    b.add(quad({-2, -2, -2}, {1.3f, 0, 0.4f}, {0, 4, 0}, b.add(bumpy)));
    b.add(box({-0.6f, -1, -2}, {0.4f, 1, -1}, b.add(glass(2.4f))));
    b.add(quad({0.5f, -2, -2}, {0.8f, 0, 0}, {0, 4, 0}, b.add(metal(Rgb(1.0f), 0.5f))));
    b.add(lookAt({0, 0, 2}, {0, 0, 0}, 60));
    const FeatureLayers layers = layersOf(b, 48);
    for (std::size_t i = 0; i < layers.z.size(); ++i) {
        const Rgb &a = layers.albedo.pixels[i], &n = layers.normal.pixels[i];
        ASSERT_TRUE(isFinite(a) && isFinite(n));
        EXPECT_GE(minComponent(a), 0.0f);
        EXPECT_LE(maxComponent(a), 1.0f);
        EXPECT_LE(length(Vec3(n.r, n.g, n.b)), 1.0f + 1e-5f);
    }
}

/// A pixel's features are the same far from the file's origin, by any number of threads, and in a
/// crop as in the whole.
TEST(Features, OfAPixelAreItsOwn) {
    SceneBuilder b;
    b.add(box({999, -61, -1}, {1061, 60, 0}, b.add(glass(1.5f))));
    b.add(wall(-3, b.add(matte(kBehind))), translation({1000, 0, 0}));
    b.add(lookAt({1000, 0, 1}, {1000, 0, 0}, 70));
    const auto scene = b.build();
    const Camera camera = scene->makeCamera("", {16, 12}, {0.1f, 3.0f});
    const ThreadPool one(1);
    const FeatureLayers all = renderFeatures(*scene, camera, {0, 16, 0, 12}, 7, pool());
    const PixelRect crop{5, 11, 3, 9};
    const FeatureLayers part = renderFeatures(*scene, camera, crop, 7, one);
    for (int y = 0; y < crop.height(); ++y) {
        for (int x = 0; x < crop.width(); ++x) {
            const auto i = std::size_t(y * crop.width() + x);
            const auto j = std::size_t((y + crop.y0) * 16 + x + crop.x0);
            EXPECT_EQ(part.albedo.pixels[i], all.albedo.pixels[j]);
            EXPECT_EQ(part.normal.pixels[i], all.normal.pixels[j]);
            EXPECT_EQ(part.z[i], all.z[j]);
            EXPECT_EQ(part.position[i], all.position[j]);
            EXPECT_NEAR(part.position[i].x, 1000, 3);
        }
    }
}

}  // namespace
}  // namespace lacuna::test
