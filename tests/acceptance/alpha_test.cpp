// A transparent background: every technique leaves the environment out where the lens sees it directly, and nowhere
// else. Alpha is the share of a pixel that shows anything else.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/material/fresnel.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

constexpr float kSky = 0.8f, kAlbedo = 0.6f;
constexpr double kEdge = 5.25;  // in pixels from the left

/// A matte sheet under an even sky; one of its edges runs through the pixels of a column. Its radiance is its albedo
/// times the sky's.
SceneBuilder sheetUnderTheSky() {
    SceneBuilder b;
    // One unit of the sheet is a pixel, and the picture has 16 x 16 of them.
    b.add(quad({-9, -9, 0}, {float(kEdge) + 1, 0, 0}, {0, 18, 0}, b.add(matte(Rgb(kAlbedo)))));
    b.add(lookAt({0, 0, 8}, {0, 0, 0}, 90));
    b.d.environment = EnvironmentDescription{};
    b.d.environment->colour = Rgb(kSky);
    return b;
}

double coverageOf(std::size_t pixel) {
    return std::clamp(kEdge - double(pixel % 16), 0.0, 1.0);
}

class TransparentBackground : public RowTest {};
INSTANTIATE_TEST_SUITE_P(All, TransparentBackground, testing::ValuesIn(rowNames(Rows::OfTheTool)),
                         ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, TransparentBackground, testing::ValuesIn(rowNames(Rows::OfTests)),
                         ByParameter());

TEST_P(TransparentBackground, holdsThingsByTheirShareOfThePixel) {
    const auto scene = sheetUnderTheSky().build();
    Shot shot;
    shot.iterations = 400;
    shot.transparentBackground = true;
    const Picture picture = render(*scene, row(), shot);
    std::vector<Rgb> exact;
    for (std::size_t i = 0; i < 256; ++i) {
        exact.push_back(Rgb(float(coverageOf(i)) * kAlbedo * kSky));
    }
    expectRadiance(picture, exact, row().name + ", sheet", Judge::BlocksAndMean);

    const std::vector<float>& alpha = picture.layers.at("A");
    ASSERT_EQ(alpha.size(), 256u);
    for (std::size_t i = 0; i < alpha.size(); ++i) {
        const double coverage = coverageOf(i);
        const double error = std::sqrt(coverage * (1 - coverage) / shot.iterations);
        EXPECT_NEAR(alpha[i], coverage, 6 * error) << i;
        if (coverage > 0) continue;
        EXPECT_EQ(picture.pixels.image().pixels[i], Rgb()) << i;
    }
}

/// The same random numbers make the same paths. So the pictures differ only by the sky that the lens sees, 1 - alpha of
/// it.
TEST(Alpha, IsWhatTheSkyLeavesOfAPixel) {
    SceneBuilder b = sheetUnderTheSky();
    b.add(box({1, -3, -1}, {3, 3, 0}, b.add(glass(1.5f))));  // the sky seen through it stays
    lacuna::Material veil = matte(Rgb(0.9f));
    veil.alphaMode = lacuna::Material::Alpha::Blend;
    veil.baseAlpha = 0.3f;
    b.add(quad({4, -8, 0}, {2, 0, 0}, {0, 16, 0}, b.add(veil)));
    b.add(quad({6, -8, 0}, {1, 0, 0}, {0, 16, 0}, b.add(pane())));
    const auto scene = b.build();
    Shot shot;
    shot.iterations = 64;
    const Image shown = render(*scene, rowNamed("pt"), shot).pixels.image();
    shot.transparentBackground = true;
    const Picture transparent = render(*scene, rowNamed("pt"), shot);
    const Image image = transparent.pixels.image();
    const std::vector<float>& alpha = transparent.layers.at("A");
    const auto meanOf = [&](int from, int to) {
        double sum = 0;
        for (int i = 0; i < 256; ++i) {
            if (i % 16 >= from && i % 16 < to) sum += double(alpha[std::size_t(i)]);
        }
        return sum / (16 * (to - from));
    };
    for (std::size_t i = 0; i < alpha.size(); ++i) {
        EXPECT_NEAR(image.pixels[i].g + kSky * (1 - alpha[i]), shown.pixels[i].g, 1e-5f) << i;
    }
    EXPECT_NEAR(meanOf(12, 14), 0.3, 0.05);  // the veil
    double reflected = 0;
    for (int y = 0; y < 16; ++y) {
        const double distance = std::hypot(8.0, 6.5, 7.5 - y);
        reflected += fresnelDielectric(8.0 / distance, 1.5) / 16;
    }
    EXPECT_NEAR(meanOf(14, 15), reflected, 5 * std::sqrt(reflected / (16 * shot.iterations)));
    EXPECT_EQ(alpha[8 * 16 + 10], 1.0f);  // glass
}

}  // namespace
}  // namespace lacuna::test
