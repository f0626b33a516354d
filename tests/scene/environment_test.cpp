// The latitude-longitude map alone (light_points_test.cpp compares densities with draws).
#include "libcore/scene/environment.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "libcore/base/error.h"
#include "tests/material/statistics.h"
#include "tests/scene/scene_builder.h"
#include "tests/scene/sphere_bins.h"

namespace lacuna::test {
namespace {

constexpr double kPiD = std::numbers::pi;

Image noise(int width, int height) {
    Image image(width, height);
    Random random(1);
    for (Rgb& c : image.pixels) c = {random.next(), random.next(), random.next()};
    return image;
}

Vec3 towards(double longitudeDegrees, double latitudeDegrees) {
    const double phi = longitudeDegrees * kPiD / 180, theta = latitudeDegrees * kPiD / 180;
    return Vec3(
        Vec3d{std::cos(theta) * std::sin(phi), std::sin(theta), -std::cos(theta) * std::cos(phi)});
}

void expectNear(const Rgb& a, const Rgb& b, float tolerance) {
    EXPECT_NEAR(a.r, b.r, tolerance);
    EXPECT_NEAR(a.g, b.g, tolerance);
    EXPECT_NEAR(a.b, b.b, tolerance);
}

/// The sides of a sky with a small sun follow the cosine to it, however the sky is turned. The sides of an even sky are
/// all alike.
TEST(Environment, SidesGetWhatIsBeforeThem) {
    const double kOff = std::sin(8 * kPiD / 180);  // from a cell's middle to its corner
    Image image(64, 32, Rgb(0.01f));
    image.at(48, 8) = Rgb(1e5f);
    for (const double turn : {0.0, 77.0}) {
        const Environment sky(image, 1.0, turn, "sky");
        const SkySides sides = sky.sides(Environment::SkyPart::AboveMean);
        const Vec3 sun = sky.sample(0.5, 0.5f, 0.5f, Environment::SkyPart::AboveMean).direction;
        Rng rng(3, 0, StreamKind::User, 0);
        double sum = 0.0;
        for (int i = 0; i < 1000; ++i) {
            const Vec3 side = randomDirection(rng);
            const float cosine = dot(side, sun);
            EXPECT_NEAR(sides.at(side), 4.0f * std::max(0.0f, cosine), 4.0 * kOff) << cosine;
            EXPECT_GT(sides.at(side), 0.0f);
            sum += double(sides.at(side)) / 1000;
        }
        EXPECT_NEAR(sum, 1.0, 0.15);
    }
    const Environment even(Image(4, 2, Rgb(1.0f)), 1.0, 0.0, "even");
    const SkySides all = even.sides(Environment::SkyPart::Whole);
    for (const Vec3 side : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0.6f, 0, 0.8f}}) {
        EXPECT_NEAR(all.at(side), 1.0f, 0.05f);
        EXPECT_EQ(SkySides().at(side), 1.0f);
    }
}

/// Especially at the borders of texels, where rounding leads into the next one.
TEST(Environment, SamplesHaveTheDensityOfTheirDirections) {
    constexpr float kLast = 1.0f - 0x1p-24f;
    int different = 0;
    for (int i = 0; i < 1000; ++i) {
        const Environment e(noise(1 + i % 17, 1 + i % 9), 1, 0.36 * i, "noise");
        for (const float u : {0.0f, 0x1p-23f, 0.5f, kLast}) {
            for (const float v : {0.0f, 0x1p-23f, 0.5f, kLast}) {
                const Environment::Sample s = e.sample(0.001 * i, u, v);
                different += s.seen.pdfW != e.pdfW(s.direction);
            }
        }
    }
    EXPECT_EQ(different, 0);
}

TEST(Environment, CentreIsMinusZRightIsPlusXTopIsPlusY) {
    const Image image = noise(12, 7);
    const Environment e(image, 1, 0, "noise");
    const auto mid = [&](int x0, int x1, int y) {
        return (image.at(x0, y) + image.at(x1, y)) * 0.5f;
    };
    expectNear(e.radiance({0, 0, -1}), mid(5, 6, 3), 1e-5f);
    expectNear(e.radiance({1, 0, 0}), mid(8, 9, 3), 1e-5f);
    expectNear(e.radiance({0, 0, 1}), mid(11, 0, 3), 1e-5f);
    expectNear(e.radiance({-1, 0, 0}), mid(2, 3, 3), 1e-5f);
    // Directions may have any length. The poles see the first and the last row.
    const Image rows = [] {
        Image i(4, 3);
        for (int x = 0; x < 4; ++x) i.at(x, 0) = Rgb(1.0f), i.at(x, 2) = Rgb(3.0f);
        return i;
    }();
    const Environment r(rows, 2, 0, "rows");
    EXPECT_EQ(r.radiance({0, 1, 0}), Rgb(2.0f));
    EXPECT_EQ(r.radiance({0, -1, 0}), Rgb(6.0f));
    EXPECT_EQ(r.radiance({1e-20f, 1, 1e-20f}), Rgb(2.0f));
}

TEST(Environment, BilinearAtCentresAndBetween) {
    const Image image = noise(10, 6);
    const Environment e(image, 1, 0, "noise");
    for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 10; ++x) {
            const double longitude = (x + 0.5) * 36 - 180, latitude = 90 - (y + 0.5) * 30;
            expectNear(e.radiance(towards(longitude, latitude)), image.at(x, y), 2e-5f);
            const Rgb right = image.at((x + 1) % 10, y);
            expectNear(e.radiance(towards(longitude + 0.25 * 36, latitude)),
                       image.at(x, y) * 0.75f + right * 0.25f, 2e-5f);
            if (y == 5) continue;
            const Rgb below = image.at(x, y + 1) * 0.5f + image.at((x + 1) % 10, y + 1) * 0.5f;
            expectNear(e.radiance(towards(longitude + 18, latitude - 0.4 * 30)),
                       (image.at(x, y) + right) * (0.5f * 0.6f) + below * 0.4f, 2e-5f);
        }
    }
}

TEST(Environment, ContinuousAcrossTheSeam) {
    for (const double rotation : {0.0, 33.0}) {
        const Environment e(noise(16, 8), 1, rotation, "noise");
        for (double latitude = -85; latitude <= 85; latitude += 5) {
            const double seam = 180 + rotation;
            expectNear(e.radiance(towards(seam - 1e-4, latitude)),
                       e.radiance(towards(seam + 1e-4, latitude)), 1e-3f);
        }
    }
}

TEST(Environment, PositiveRotationTurnsFromMinusZTowardsPlusX) {
    const Image image = noise(9, 5);
    const Environment e(image, 1, 0, "noise");
    expectNear(Environment(image, 1, 90, "noise").radiance({1, 0, 0}), e.radiance({0, 0, -1}),
               1e-5f);
    Rng rng(1, 0, StreamKind::User, 0);
    for (const double degrees : {90.0, -90.0, 360.0, 765.0, -1e-9, 12.5}) {
        const Environment turned(image, 1, degrees, "noise");
        // A right-handed rotation about +Y takes -Z to -X, so the sign is the opposite.
        const Affine turn = rotation({0, 1, 0}, -degrees);
        int differentTexel = 0;
        for (int i = 0; i < 500; ++i) {
            const Vec3 d = randomDirection(rng), moved(turn.vector(Vec3d(d)));
            expectNear(turned.radiance(moved), e.radiance(d), 1e-4f);
            differentTexel += std::abs(turned.pdfW(moved) - e.pdfW(d)) > 1e-5f * e.pdfW(d);
        }
        EXPECT_LE(differentTexel, 1) << degrees;
    }
}

TEST(Environment, DensityWhereverThereIsLight) {
    Image image(64, 32);
    Random random(3);
    for (int i = 0; i < 40; ++i) {
        image.at(int(random.next() * 64), int(random.next() * 32)) = Rgb(random.next(), 0, 0);
    }
    image.at(5, 5) = Rgb(1e10f);  // texels below 2^-53 of all have no density
    const Environment e(image, 1, 12, "sparse");
    Rng rng(2, 0, StreamKind::User, 0);
    int lit = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 d = randomDirection(rng);
        if (isBlack(e.radiance(d))) continue;
        ++lit;
        ASSERT_GT(e.pdfW(d), 0.0f);
    }
    EXPECT_GT(lit, 1000);
}

TEST(Environment, IntegralIsThatOfTheRadiance) {
    // The integral adds texel means; the sum uses a fine grid. A bilinear tent is not flat in solid angle, a small
    // difference.
    const Environment e(noise(32, 16), 3, 10, "noise");
    const SphereBins bins(Vec3{0, 1, 0}, 64, 64);
    double sum = 0;
    for (const double m : bins.integrate([&](Vec3 d) { return mean(e.radiance(d)); }, 4)) sum += m;
    EXPECT_NEAR(mean(e.integral()) / sum, 1, 2e-3);
    const Environment grey(Image(1, 1, Rgb(2.0f)), 0.5, 0, "grey");
    EXPECT_NEAR(grey.integral().g, 4 * kPiD, 1e-5);
    EXPECT_NEAR(grey.pdfW({0, 1, 0}), 0.25 / kPiD, 1e-7);
}

/// Texels near the poles are small, but all directions of an even sky are equally likely.
TEST(Environment, DirectionsOfAnEvenSkyAreAllAlike) {
    const Environment e(Image(16, 9, Rgb(0.5f, 3.0f, 1.0f)), 1, 40, "even");
    Rng rng(4, 0, StreamKind::User, 0);
    for (int i = 0; i < 500; ++i) {
        EXPECT_NEAR(e.pdfW(randomDirection(rng)) * 4 * kPiD, 1, 1e-6);
        const Environment::Sample s = e.sample(rng.uniformDouble(), rng.uniform(), rng.uniform());
        EXPECT_NEAR(s.seen.pdfW * 4 * kPiD, 1, 1e-6);
    }
}

/// Both ways to draw directions give the integrals of 1, x^2, y and z. False alarms: 8 comparisons at 5 errors, 5e-6.
TEST(Environment, DrawsTheSameFromASquare) {
    Image image(8, 5);
    Rng rng(5, 0, StreamKind::User, 0);
    for (Rgb& texel : image.pixels) texel = Rgb(std::pow(10.0f, 2 * rng.uniform()));
    const Environment e(image, 1, 25, "uneven");
    for (const bool square : {false, true}) {
        Moments moments[4];
        int others = 0;  // directions that rounding takes into the next texel
        for (int i = 0; i < 100'000; ++i) {
            const double a = rng.uniformDouble(), b = rng.uniformDouble();
            const Environment::Sample s =
                square ? e.sampleSquare(a, b) : e.sample(a, float(b), rng.uniform());
            others += std::fabs(e.pdfW(s.direction) / s.seen.pdfW - 1) > 1e-3;
            const double w = 1 / double(s.seen.pdfW);
            const Vec3d d(s.direction);
            const double values[] = {w, w * d.x * d.x, w * d.y, w * d.z};
            for (int k = 0; k < 4; ++k) moments[k].add(values[k]);
        }
        EXPECT_LE(others, 20);
        const double exact[] = {4 * kPiD, 4 * kPiD / 3, 0, 0};
        for (int k = 0; k < 4; ++k) {
            EXPECT_LT(std::fabs(moments[k].mean() - exact[k]), 5 * moments[k].standardError())
                << k << square;
        }
    }
    // The corners of the square.
    for (const double a : {0.0, 0x1.fffffffffffffp-1}) {
        for (const double b : {0.0, 0x1.fffffffffffffp-1}) {
            EXPECT_GT(e.sampleSquare(a, b).seen.pdfW, 0.0f);
        }
    }
}

/// Directions that are drawn from the part above the mean have the stated density. Compares integrals of 1, x^2, y and
/// z over all directions where it is not zero. False alarms: 8 comparisons at 5 errors, 5e-6.
TEST(Environment, WhatIsAboveTheMeanIsDrawnAsItSays) {
    Image image(8, 5);
    Rng rng(10, 0, StreamKind::User, 0);
    for (Rgb& texel : image.pixels) texel = Rgb(std::pow(10.0f, rng.uniform()));
    const Environment e(image, 1, 25, "uneven");
    const auto valuesOf = [](const Vec3& d) {
        return std::array{1.0, double(d.x * d.x), double(d.y), double(d.z)};
    };
    constexpr int kDraws = 100'000;
    Moments exact[4];
    for (int i = 0; i < kDraws; ++i) {
        const Vec3 d = randomDirection(rng);
        const bool isAbove = e.aboveMean(d) > 0.0;
        const auto values = valuesOf(d);
        for (int k = 0; k < 4; ++k) exact[k].add(isAbove ? values[k] * 4 * kPiD : 0.0);
    }
    for (const bool square : {false, true}) {
        Moments moments[4];
        int others = 0;  // directions that rounding takes into the next cell
        for (int i = 0; i < kDraws; ++i) {
            const double a = rng.uniformDouble(), b = rng.uniformDouble();
            const Environment::Sample s =
                square ? e.sampleSquare(a, b, Environment::SkyPart::AboveMean)
                       : e.sample(a, float(b), rng.uniform(), Environment::SkyPart::AboveMean);
            EXPECT_EQ(s.seen.pdfW, e.pdfW(s.direction));
            const double density = double(s.seen.pdfW) * e.aboveMean(s.direction);
            others += density == 0.0;
            const auto values = valuesOf(s.direction);
            for (int k = 0; k < 4; ++k) moments[k].add(density > 0.0 ? values[k] / density : 0.0);
        }
        EXPECT_LE(others, 20);
        for (int k = 0; k < 4; ++k) {
            EXPECT_LT(std::fabs(moments[k].mean() - exact[k].mean()),
                      5 * std::hypot(moments[k].standardError(), exact[k].standardError()))
                << k << square;
        }
    }
}

/// A disc of half a degree, 10^5 times as bright as the sky around it: a few texels and a rim. It is sampled as well as
/// a lamp: radiance over density is the same for all its directions, except that the cosine to +Y is not linear within
/// a row.
TEST(Environment, ASunIsDrawnAsItShines) {
    for (const int height : {256, 1024}) {
        Image image(2 * height, height, Rgb(1.0f));
        const Vec3d sun = normalize(Vec3d{0.4, 0.6, -0.7});
        for (int y = 0; y < height / 2; ++y) {
            for (int x = 0; x < 2 * height; ++x) {
                const double longitude = 360.0 * (x + 0.5) / (2 * height) - 180;
                const Vec3 d = towards(longitude, 90 - 180.0 * (y + 0.5) / height);
                const double cosine = dot(Vec3d(d), sun);
                // The rim has half the brightness, as in renders and photographs.
                if (cosine > std::cos(0.0046))
                    image.at(x, y) = Rgb(1e5f, 0.9e5f, 0.8e5f);
                else if (cosine > std::cos(0.0046 + 3.0 / height))
                    image.at(x, y) = Rgb(3e4f);
            }
        }
        const Environment e(image, 1, 30, "sun");
        Rng rng(6, 0, StreamKind::User, 0);
        Moments ratio;
        double least = 1e9, most = 0;
        for (int i = 0; i < 50'000; ++i) {
            const Environment::Sample s =
                e.sample(rng.uniformDouble(), rng.uniform(), rng.uniform());
            const double r =
                double(mean(e.radiance(s.direction))) / double(s.seen.pdfW * mean(e.integral()));
            ratio.add(r);
            if (std::abs(s.direction.y) > 0.99f) continue;  // rows at the poles are less even
            least = std::min(least, r);
            most = std::max(most, r);
        }
        EXPECT_NEAR(ratio.mean(), 1, 1e-3) << height;
        EXPECT_GT(least, 0.95) << height;
        EXPECT_LT(most, 1.05) << height;
    }
}

/// A direction's point of the square gives that direction again, however texels differ.
TEST(Environment, SquaresAndDirectionsAreEachOthersInverse) {
    Image image(12, 7);
    Random random(8);
    for (Rgb& texel : image.pixels) texel = Rgb(std::pow(10.0f, 4 * random.next()));
    for (int x = 3; x < 6; ++x) image.at(x, 2) = image.at(x, 3) = Rgb();  // a cell without light
    const Environment e(image, 1, -70, "uneven");
    Rng rng(7, 0, StreamKind::User, 0);
    for (int i = 0; i < 20'000; ++i) {
        const double across = rng.uniformDouble(), down = rng.uniformDouble();
        const Environment::Sample s = e.sampleSquare(across, down);
        const SquarePoint back = e.squareOf(s.direction);
        ASSERT_NEAR(back[1], down, 1e-4);
        ASSERT_NEAR(back[0], across, 2e-3) << down;
        ASSERT_GT(s.seen.pdfW, 0.0f);
    }
}

/// The short cut for one texel gives the same as the way for many.
TEST(Environment, ATexelIsAsGoodAsTwoOfIt) {
    const Rgb grey(0.5f, 3.0f, 1.0f);
    const Environment one(Image(1, 1, grey), 2, -70, "one"), two(Image(1, 2, grey), 2, -70, "two");
    Rng rng(9, 0, StreamKind::User, 0);
    for (int i = 0; i < 2000; ++i) {
        const double across = rng.uniformDouble(), down = rng.uniformDouble();
        const Environment::Sample a = one.sampleSquare(across, down),
                                  b = two.sampleSquare(across, down);
        EXPECT_LT(length(Vec3d(a.direction) - Vec3d(b.direction)), 2e-6);
        EXPECT_NEAR(a.seen.pdfW, b.seen.pdfW, 1e-6f);
        EXPECT_EQ(a.seen.pdfW, one.pdfW(a.direction));
        EXPECT_EQ(a.seen.pdfW, one.seen(a.direction).pdfW);
        expectNear(one.radiance(a.direction), two.seen(b.direction).radiance, 1e-6f);
        const SquarePoint back = one.squareOf(a.direction);
        EXPECT_NEAR(back[0], across, 2e-3) << down;
        EXPECT_NEAR(back[1], down, 1e-4);
    }
}

TEST(Environment, RefusesWhatIsNoRadiance) {
    Image image(4, 3, Rgb(1.0f));
    EXPECT_TRUE(Environment(Image(4, 3), 1, 0, "black").black());
    EXPECT_TRUE(Environment(image, 0, 0, "scaled to nothing").black());
    EXPECT_EQ(Environment(Image(4, 3), 1, 0, "black").pdfW({0, 1, 0}), 0.0f);
    EXPECT_THROW(Environment(Image(), 1, 0, "empty"), InputError);
    EXPECT_THROW(Environment(image, -1, 0, "negative scale"), InputError);
    EXPECT_THROW(Environment(image, 1e39, 0, "overflow"), InputError);
    for (const float bad : {-1e-3f, std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()}) {
        image.at(2, 1).g = bad;
        try {
            Environment e(image, 1, 0, "sky.exr");
            FAIL() << bad;
        } catch (const InputError& error) {
            EXPECT_EQ(std::string(error.what()).rfind("sky.exr: ", 0), 0u) << error.what();
            EXPECT_NE(std::string(error.what()).find("2,1"), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace lacuna::test
