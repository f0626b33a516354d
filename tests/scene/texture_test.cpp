#include "libcore/scene/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/material/statistics.h"

namespace lacuna::test {
namespace {

using Wrap = Texture::Wrap;

Texture noise(int width, int height, bool srgb = false, Wrap u = Wrap::Repeat,
              Wrap v = Wrap::Repeat) {
    Texture t;
    t.width = width;
    t.height = height;
    t.srgb = srgb;
    t.wrapU = u;
    t.wrapV = v;
    Random random(1);
    for (int i = 0; i < 4 * width * height; ++i)
        t.rgba.push_back(std::uint8_t(random.next() * 256));
    return t;
}

double exactSrgb(int code) {
    const double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

int code(const Texture& t, int x, int y, int channel) {
    return t.rgba[std::size_t((y * t.width + x) * 4 + channel)];
}

void expectSame(const Rgba& a, const Rgba& b, float tolerance) {
    EXPECT_NEAR(a.rgb.r, b.rgb.r, tolerance);
    EXPECT_NEAR(a.rgb.g, b.rgb.g, tolerance);
    EXPECT_NEAR(a.rgb.b, b.rgb.b, tolerance);
    EXPECT_NEAR(a.alpha, b.alpha, tolerance);
}

TEST(Texture, EverySrgbCodeAndLinearAlpha) {
    for (const bool srgb : {true, false}) {
        Texture t;
        t.width = 256;
        t.height = 1;
        t.srgb = srgb;
        for (int i = 0; i < 256; ++i) {
            const auto c = std::uint8_t(i);
            t.rgba.insert(t.rgba.end(), {c, c, c, c});
        }
        for (int i = 0; i < 256; ++i) {
            const Rgba c = sampleTexture(t, {(float(i) + 0.5f) / 256, 0.5f});
            const double expected = srgb ? exactSrgb(i) : i / 255.0;
            EXPECT_NEAR(c.rgb.r, expected, 1e-6 * expected + 1e-9) << i;
            EXPECT_NEAR(c.rgb.b, expected, 1e-6 * expected + 1e-9) << i;
            EXPECT_NEAR(c.alpha, i / 255.0, 1e-6) << i;
        }
    }
}

TEST(Texture, NearestTexelAndNoneBesideIt) {
    for (const Wrap wrap : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge}) {
        Texture t = noise(8, 4, true, wrap, wrap);
        t.nearest = true;
        for (int y = 0; y < 4; ++y) {
            for (int x = 0; x < 8; ++x) {
                for (const auto& [fx, fy] : {std::pair{0.5, 0.5}, {0.01, 0.99}, {0.99, 0.01}}) {
                    const Rgba c = sampleTexture(t, {float((x + fx) / 8), float((y + fy) / 4)});
                    EXPECT_NEAR(c.rgb.r, exactSrgb(code(t, x, y, 0)), 2e-6);
                    EXPECT_NEAR(c.alpha, code(t, x, y, 3) / 255.0, 2e-6);
                }
            }
        }
    }
    Texture t = noise(8, 4);
    t.nearest = true;
    expectSame(sampleTexture(t, {1.0f, 1.0f}), sampleTexture(t, {0.01f, 0.01f}), 0.0f);
    expectSame(sampleTexture(t, {-0.01f, 0.1f}), sampleTexture(t, {0.99f, 0.1f}), 0.0f);
}

TEST(Texture, BilinearBetweenLinearColours) {
    const Texture t = noise(8, 4, true);
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 7; ++x) {
            for (const auto& [fx, fy] : {std::pair{0.0, 0.0}, {0.25, 0.5}, {0.75, 0.125}}) {
                const Vec2 uv{float((x + 0.5 + fx) / 8), float((y + 0.5 + fy) / 4)};
                const auto at = [&](int channel, auto decode) {
                    return (decode(code(t, x, y, channel)) * (1 - fx) +
                            decode(code(t, x + 1, y, channel)) * fx) *
                               (1 - fy) +
                           (decode(code(t, x, y + 1, channel)) * (1 - fx) +
                            decode(code(t, x + 1, y + 1, channel)) * fx) *
                               fy;
                };
                const Rgba c = sampleTexture(t, uv);
                EXPECT_NEAR(c.rgb.r, at(0, exactSrgb), 2e-6);
                EXPECT_NEAR(c.rgb.g, at(1, exactSrgb), 2e-6);
                EXPECT_NEAR(c.rgb.b, at(2, exactSrgb), 2e-6);
                EXPECT_NEAR(c.alpha, at(3, [](int k) { return k / 255.0; }), 2e-6);
            }
        }
    }
}

TEST(Texture, OriginIsTheUpperLeftCorner) {
    const Texture t = noise(4, 2, false, Wrap::ClampToEdge, Wrap::ClampToEdge);
    EXPECT_NEAR(sampleTexture(t, {0, 0}).rgb.r, code(t, 0, 0, 0) / 255.0, 1e-6);
    EXPECT_NEAR(sampleTexture(t, {1, 0}).rgb.r, code(t, 3, 0, 0) / 255.0, 1e-6);
    EXPECT_NEAR(sampleTexture(t, {0, 1}).rgb.r, code(t, 0, 1, 0) / 255.0, 1e-6);
}

TEST(Texture, RepeatIsPeriodic) {
    const Texture t = noise(8, 4);
    Random random(2);
    for (int i = 0; i < 300; ++i) {
        // Multiples of 2^-10: exact in float even after a large shift.
        const float u = float(int(random.next() * 1024)) / 1024,
                    v = float(int(random.next() * 1024)) / 1024;
        const Rgba c = sampleTexture(t, {u, v});
        for (const float shift : {-1.0f, 1.0f, -7.0f, 1000.0f, -4096.0f}) {
            expectSame(sampleTexture(t, {u + shift, v - shift}), c, 1e-6f);
        }
    }
    // Across the border: the mean of the first and the last column.
    const float seam = float(code(t, 0, 0, 0) + code(t, 7, 0, 0)) / 510;
    EXPECT_NEAR(sampleTexture(t, {0, 0.125f}).rgb.r, seam, 1e-6f);
    EXPECT_NEAR(sampleTexture(t, {1, 0.125f}).rgb.r, seam, 1e-6f);
    EXPECT_NEAR(sampleTexture(t, {-1e-20f, 0.125f}).rgb.r, seam, 1e-6f);
}

TEST(Texture, MirroredRepeatTurnsBack) {
    const Texture t = noise(8, 4, false, Wrap::MirroredRepeat, Wrap::MirroredRepeat);
    const Texture clamped = noise(8, 4, false, Wrap::ClampToEdge, Wrap::ClampToEdge);
    Random random(3);
    for (int i = 0; i < 300; ++i) {
        const float u = float(int(random.next() * 1024)) / 1024,
                    v = float(int(random.next() * 1024)) / 1024;
        const Rgba c = sampleTexture(clamped, {u, v});  // inside, both are the same
        for (const float shift : {0.0f, 2.0f, -2.0f, 100.0f, -4096.0f}) {
            expectSame(sampleTexture(t, {shift + u, v}), c, 1e-6f);
            expectSame(sampleTexture(t, {shift - u, v}), c, 1e-6f);
            expectSame(sampleTexture(t, {u, shift - v}), c, 1e-6f);
        }
        expectSame(sampleTexture(t, {2 - u, 2 + v}), c, 1e-6f);
    }
}

TEST(Texture, ClampHoldsTheEdge) {
    const Texture t = noise(8, 4, false, Wrap::ClampToEdge, Wrap::Repeat);
    for (const float v : {0.1f, 0.6f}) {
        for (const float u : {-1e-3f, -1.0f, -5.5f, -1e30f}) {
            expectSame(sampleTexture(t, {u, v}), sampleTexture(t, {0, v}), 1e-6f);
        }
        for (const float u : {1.001f, 2.0f, 77.0f, 1e30f}) {
            expectSame(sampleTexture(t, {u, v}), sampleTexture(t, {1, v}), 1e-6f);
        }
    }
}

TEST(Texture, HugeCoordinatesStayInside) {
    for (const Wrap wrap : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge}) {
        for (const int size : {1, 2, 5}) {
            const Texture t = noise(size, size, true, wrap, wrap);
            for (const float u : {1e6f, -1e6f, 1e18f, -1e18f, 3e38f, -3e38f, 0x1p31f, -0x1p31f,
                                  1e-38f, -1e-38f, 0.99999994f}) {
                for (const float v : {u, 0.5f}) {
                    const Rgba c = sampleTexture(t, {u, v});
                    EXPECT_TRUE(isFinite(c.rgb) && c.alpha >= 0.0f && c.alpha <= 1.000001f) << u;
                    // Floats of that size are even integers, where the texture begins.
                    if (std::abs(u) < 1e6f || wrap == Wrap::ClampToEdge) continue;
                    expectSame(c, sampleTexture(t, {0, v == u ? 0 : v}), 1e-6f);
                }
            }
        }
    }
}

TEST(Texture, OneTexelIsConstant) {
    for (const Wrap wrap : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge}) {
        Texture t = noise(1, 1, true, wrap, wrap);
        t.rgba = {128, 0, 255, 64};
        Random random(4);
        for (int i = 0; i < 100; ++i) {
            const Rgba c = sampleTexture(t, {20 * random.next() - 10, 20 * random.next() - 10});
            EXPECT_NEAR(c.rgb.r, exactSrgb(128), 1e-6);
            EXPECT_EQ(c.rgb.g, 0.0f);
            EXPECT_NEAR(c.rgb.b, 1.0, 1e-6);
            EXPECT_NEAR(c.alpha, 64 / 255.0, 1e-6);
        }
    }
}

}  // namespace
}  // namespace lacuna::test
