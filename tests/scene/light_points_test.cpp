// Which light is picked, and which point on it: draws compared with densities. False alarms: 1e-3 over all comparisons
// of this file.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "libcore/scene/environment.h"
#include "libcore/scene/light.h"
#include "libcore/scene/texture.h"
#include "tests/base/chi_square.h"
#include "tests/scene/scene_builder.h"
#include "tests/scene/sphere_bins.h"

namespace lacuna::test {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr double kSignificance = 1e-3 / 16;  // Sidak of fewer than 16 comparisons

EmissiveTriangle emissive(Vec3 a, Vec3 b, Vec3 c, Rgb radiance, bool twoSided = false,
                          const Texture* texture = nullptr) {
    EmissiveTriangle t;
    t.corners = {a, b, c};
    t.uvs = {Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}};
    t.radiance = radiance;
    t.twoSided = twoSided;
    t.texture = texture;
    return t;
}

/// Left half black, right half bright, mostly red; linear.
Texture halfTexture() {
    Texture t;
    t.width = t.height = 2;
    t.rgba = {0, 0, 0, 255, 255, 51, 0, 255, 0, 0, 0, 255, 255, 51, 0, 255};
    t.wrapU = t.wrapV = Texture::Wrap::ClampToEdge;
    return t;
}

const std::vector<EmissiveTriangle>& threeTriangles() {
    static const Texture texture = halfTexture();
    static const std::vector<EmissiveTriangle> t{
        emissive({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, Rgb(3.0f)),
        emissive({0, 0, 1}, {0, 3, 1}, {0, 0, 2}, Rgb(1, 2, 3), true),
        emissive({5, 5, 5}, {5, 6, 5}, {5, 5, 6}, Rgb(4.0f), false, &texture)};
    return t;
}

TEST(LightSelection, ProportionalToPower) {
    const Environment environment(Image(4, 2, Rgb(0.5f)), 2.0, 0, "grey");
    const std::vector<EmissiveTriangle> triangles{
        emissive({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, Rgb(3.0f)),
        emissive({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, Rgb(3.0f), true),
        emissive({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, Rgb(0.0f))};
    const std::vector<PunctualLight> punctual{
        pointLight({1, 2, 3}, Rgb(1, 2, 6)), pointLight({1, 2, 3}, Rgb(0.0f)),
        spotLight({}, {1, 0, 0}, Rgb(5.0f), 0.4, 0.9), directionalLight({0, -1, 0}, Rgb(0.1f)),
        directionalLight({0, 1, 0}, Rgb(0.0f))};
    const float radius = 3;
    const Lights lights(triangles, punctual, {}, &environment, radius);
    ASSERT_EQ(lights.size(), 9u);
    ASSERT_FALSE(lights.empty());

    // The spot's falloff, integrated over the cosine as it is defined.
    double spot = 0;
    constexpr int kSteps = 100'000;
    const double co = std::cos(0.9), ci = std::cos(0.4);
    for (int i = 0; i < kSteps; ++i) {
        const double c = co + (1 - co) * (i + 0.5) / kSteps;
        spot += 2 * kPiD * (1 - co) / kSteps * std::pow(std::min(1.0, (c - co) / (ci - co)), 2);
    }
    const double disk = kPiD * std::pow(double(lights.diskRadius()), 2);
    const std::vector<double> power{3 * kPiD, 6 * kPiD,   0, 3 * 4 * kPiD,   0,
                                    5 * spot, 0.1 * disk, 0, 4 * kPiD * disk};
    double total = 0, sum = 0;
    for (const double p : power) total += p;
    std::vector<double> pmf;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        pmf.push_back(lights.pmf(i));
        sum += pmf.back();
        EXPECT_NEAR(pmf.back(), power[i] / total, 1e-6 * power[i] / total) << i;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_EQ(lights.pmf(9), 0.0);

    constexpr int kSamples = 100'000;
    std::vector<std::uint64_t> counts(9);
    for (int i = 0; i < kSamples; ++i) {
        Rng rng(1, 0, StreamKind::User, unsigned(i));
        const LightPoint p = lights.samplePoint(rng);
        ASSERT_GT(power[p.light], 0.0);
        ASSERT_EQ(p.kind, lights.kind(p.light));
        ASSERT_GT(p.pdf, 0.0f);
        if (p.kind == LightKind::Point || p.kind == LightKind::Spot ||
            p.kind == LightKind::Directional) {
            ASSERT_EQ(p.pdf, float(lights.pmf(p.light)));
        }
        ++counts[p.light];
    }
    EXPECT_GT(chiSquareSignificance(counts, pmf, kSamples), kSignificance);
}

/// The power of varying emission is that of its mean, however small the bright part is.
TEST(LightSelection, PowerOfTexturesAndAlpha) {
    // Nine bright texels of 64 x 64, as a texture and as a mask. A grid of 36 samples misses them.
    Texture star;
    star.width = star.height = 64;
    star.rgba.assign(64 * 64 * 4, 0);
    const auto light = [&](int x, int y) {
        for (int c = 0; c < 4; ++c) star.rgba[std::size_t((y * 64 + x) * 4 + c)] = 255;
    };
    for (int y = 9; y < 12; ++y) {
        for (int x = 14; x < 17; ++x) light(x, y);
    }
    EmissiveTriangle plain = emissive({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, Rgb(3.0f));
    EmissiveTriangle textured = plain;
    textured.texture = &star;
    lacuna::Material mask;
    mask.alphaMode = lacuna::Material::Alpha::Mask;
    mask.baseColorTexture.value = 0;
    EmissiveTriangle masked = plain;
    masked.alpha = TriangleAlpha{&mask, &star, plain.uvs, {1, 1, 1}};
    lacuna::Material hidden;
    hidden.alphaMode = lacuna::Material::Alpha::Mask;
    hidden.baseAlpha = 0.4f;
    EmissiveTriangle gone = plain;
    gone.alpha = TriangleAlpha{&hidden, nullptr, {}, {1, 1, 1}};

    const Lights lights({plain, textured, masked, gone}, {}, {}, nullptr, 1.0f);
    EXPECT_EQ(lights.pmf(3), 0.0);
    // 9 of 2048 texels of the triangle, plus a thousandth that keeps it pickable.
    const double share = 9.0 / 2048;
    EXPECT_NEAR(lights.pmf(1) / lights.pmf(0), share + 1e-3, 0.3 * share);
    EXPECT_NEAR(lights.pmf(2) / lights.pmf(0), share + 1e-3, 0.3 * share);

    // A texel that no sample of the texture meets still gets light paths.
    Texture spark;
    spark.width = spark.height = 1024;
    spark.rgba.assign(std::size_t(1024) * 1024 * 4, 0);
    spark.rgba[(333 * 1024 + 237) * 4] = 255;
    textured.texture = &spark;
    EXPECT_GT(Lights({textured}, {}, {}, nullptr, 1.0f).pmf(0), 0.0);
    EXPECT_GT(Lights({plain, textured}, {}, {}, nullptr, 1.0f).pmf(1), 1e-4);
}

TEST(LightSelection, NothingToPick) {
    EXPECT_TRUE(Lights({}, {}, {}, nullptr, 1.0f).empty());
    const Environment black(Image(4, 2), 1, 0, "black");
    const std::vector<PunctualLight> dark{pointLight({}, Rgb(0.0f))};
    const Lights lights({emissive({}, {1, 0, 0}, {0, 1, 0}, Rgb(0.0f))}, dark, {}, &black, 1.0f);
    EXPECT_TRUE(lights.empty());
    EXPECT_EQ(lights.size(), 3u);
    // An eye path that hits a black light still gets finite values.
    const LightPoint area = lights.areaPoint(0, {}, {0, 0, 1}, {0.2f, 0.2f});
    EXPECT_EQ(area.pdf, 0.0f);
    EXPECT_TRUE(isBlack(area.exitance));
    const LightPoint sky = lights.environmentPoint({0, 1, 0});
    EXPECT_EQ(sky.pdf, 0.0f);
    EXPECT_TRUE(isBlack(sky.exitance));
}

/// Exitances of lights that are too bright or too dark for floats are in another unit. For powers of two, the numbers
/// stay the same. Ordinary exitances are those of the file.
TEST(LightUnit, KeepsThePowerNearOne) {
    struct Found {
        double unit;
        std::vector<Rgb> exitance;
    };
    const auto found = [](float brightness) {
        Image sky(4, 2);
        for (Rgb& c : sky.pixels) c = Rgb(2, 3, 4) * brightness;
        const Environment environment(sky, 1, 0, "sky");
        const std::vector<PunctualLight> punctual{pointLight({}, Rgb(0.5f * brightness))};
        const Lights lights({emissive({}, {1, 0, 0}, {0, 1, 0}, Rgb(5, 6, 7) * brightness)},
                            punctual, {}, &environment, 1.0f);
        Found f{lights.unit(), {lights.environmentPoint({0, 1, 0}).exitance}};
        for (unsigned i = 0; i < 50; ++i) {
            Rng rng(4, 0, StreamKind::User, i);
            f.exitance.push_back(lights.samplePoint(rng).exitance);
        }
        return f;
    };
    const Found one = found(1);
    EXPECT_EQ(one.unit, 1.0);
    EXPECT_EQ(one.exitance[0], Rgb(2, 3, 4));
    for (const int exponent : {-100, -80, -50, 50, 80, 100, 120}) {
        const Found f = found(std::ldexp(1.0f, exponent));
        EXPECT_EQ(f.unit == 1.0, std::abs(exponent) == 50) << exponent;
        for (std::size_t i = 0; i < f.exitance.size(); ++i) {
            const Rgb& c = f.exitance[i];
            const double inFile = std::ldexp(f.unit, -exponent);
            EXPECT_EQ(double(c.r) * inFile, double(one.exitance[i].r)) << exponent;
            EXPECT_EQ(double(c.b) * inFile, double(one.exitance[i].b)) << exponent;
            if (f.unit == 1.0) continue;
            EXPECT_LT(c.r, 100.0f) << exponent;
            EXPECT_GT(c.r, 0.001f) << exponent;
        }
    }
}

TEST(AreaLight, PointsAgainstDensity) {
    const Lights lights(threeTriangles(), {}, {}, nullptr, 10.0f);
    constexpr int kSamples = 200'000, kGrid = 8;
    std::vector<std::uint64_t> counts(3 * kGrid * kGrid);
    Moments measure;
    for (int i = 0; i < kSamples; ++i) {
        Rng rng(2, 0, StreamKind::User, unsigned(i));
        const LightPoint p = lights.samplePoint(rng);
        const EmissiveTriangle& t = threeTriangles()[p.light];
        // Uniform in area: the square root of the distance from corner 0, and the share along the opposite side.
        ASSERT_TRUE(p.uv.x >= 0 && p.uv.y >= 0 && p.uv.x + p.uv.y <= 1 + 1e-6f);
        const double s = p.uv.x + p.uv.y, share = s > 0 ? p.uv.y / s : 0;
        ++counts[(p.light * kGrid + std::min(kGrid - 1, int(s * s * kGrid))) * kGrid +
                 std::min(kGrid - 1, int(share * kGrid))];
        measure.add(1 / double(p.pdf));
        const Vec3 expected =
            t.corners[0] * (1 - p.uv.x - p.uv.y) + t.corners[1] * p.uv.x + t.corners[2] * p.uv.y;
        ASSERT_LT(length(p.position - expected), 2e-6f);
        const Vec3 n = normalize(cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]));
        ASSERT_LT(length(p.ng - n), 1e-6f);
    }
    std::vector<double> expected;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        expected.push_back(lights.pmf(std::uint32_t(i / (kGrid * kGrid))) / (kGrid * kGrid));
    }
    EXPECT_GT(chiSquareSignificance(counts, expected, kSamples), kSignificance);
    const double area = 1 + 1.5 + 0.5;
    EXPECT_GT(normalTail(std::abs(measure.mean() - area) / measure.standardError(), 2),
              kSignificance);
}

TEST(AreaLight, HitPointAsIfItHadBeenDrawn) {
    const Lights lights(threeTriangles(), {}, {}, nullptr, 10.0f);
    for (unsigned i = 0; i < 1000; ++i) {
        Rng rng(3, 0, StreamKind::User, i);
        const LightPoint p = lights.samplePoint(rng);
        const LightPoint q = lights.areaPoint(p.light, p.position, p.ng, p.uv);
        ASSERT_EQ(q.pdf, p.pdf);
        ASSERT_EQ(q.exitance, p.exitance);
        ASSERT_EQ(q.ng, p.ng);
        ASSERT_EQ(q.kind, LightKind::Area);
        // The radiance towards the front is the material's.
        const EmissiveTriangle& t = threeTriangles()[p.light];
        Rgb radiance = t.radiance;
        if (t.texture) radiance *= sampleTexture(*t.texture, {p.uv.x, p.uv.y}).rgb;
        const Rgb seen = q.exitance * lights.emission(q, q.ng, {}).profile;
        ASSERT_NEAR(seen.r, radiance.r, 1e-6f * radiance.r);
        ASSERT_NEAR(seen.b, radiance.b, 1e-6f * radiance.b);
    }
}

TEST(AreaLight, TinyAndHugeTriangles) {
    // Sides from 1e-18 to 1e9: normals have unit length, and densities are positive and finite.
    for (const float size : {1e-18f, 1e-12f, 1e-9f, 1e-6f, 1.0f, 1e6f, 1e9f}) {
        const Lights lights({emissive({0, 0, 0}, {size, 0, 0}, {0, 0, size}, Rgb(1.0f))}, {}, {},
                            nullptr, 2 * size);
        Rng rng(4, 0, StreamKind::User, 0);
        ASSERT_FALSE(lights.empty()) << size;
        const LightPoint p = lights.samplePoint(rng);
        EXPECT_LT(length(p.ng - Vec3{0, -1, 0}), 1e-6f) << size;
        EXPECT_NEAR(p.pdf * (0.5f * size * size), 1.0f, 1e-5f) << size;
    }
}

struct Map {
    const char* name;
    Image image;
    double rotation;
};

std::vector<Map> maps() {
    std::vector<Map> maps;
    maps.push_back({"one texel", Image(1, 1, Rgb(2.0f)), 0});
    Image noise(16, 8);
    Random random(5);
    for (Rgb& c : noise.pixels) c = {random.next(), random.next() + 0.1f, random.next()};
    maps.push_back({"noise", noise, 0});
    maps.push_back({"noise, turned", noise, 77});
    Image bright(32, 16);
    bright.at(0, 5) = Rgb(1e6f);  // at the seam
    maps.push_back({"one bright texel", bright, -30});
    Image poles(8, 8);
    for (int x = 0; x < 8; ++x) poles.at(x, 0) = poles.at(x, 7) = Rgb(float(x), 1, 0);
    maps.push_back({"poles", poles, 0});
    Image row(6, 9);
    for (int x = 0; x < 6; ++x) row.at(x, 4) = Rgb(1.0f);
    maps.push_back({"black rows", row, 123});
    return maps;
}

/// Quarters of texels. Each lies between four texel centres, where the density is bilinear in longitude and cosine, so
/// its mean is the value in the middle.
struct TexelQuarters {
    int width, height;
    double rotationDegrees;

    int size() const { return 4 * width * height; }
    double solidAngle(int quarter) const {
        return kPiD / width * (cosine(quarter / (2 * width)) - cosine(quarter / (2 * width) + 1));
    }
    /// theory.md, "Lights": longitude from -Z towards +X, the image's centre at 0, the top row at +Y.
    Vec3 centre(int quarter) const {
        const int row = quarter / (2 * width), column = quarter % (2 * width);
        const double turn = (column + 0.5) / (2 * width) - 0.5 + rotationDegrees / 360;
        const double phi = 2 * kPiD * turn, c = 0.5 * (cosine(row) + cosine(row + 1));
        const double s = std::sqrt(1 - c * c);
        return Vec3(Vec3d{s * std::sin(phi), c, -s * std::cos(phi)});
    }
    int find(Vec3 d) const {
        double u = std::atan2(d.x, -d.z) / (2 * kPiD) - rotationDegrees / 360 + 0.5;
        u -= std::floor(u);
        const double theta = std::atan2(std::hypot(double(d.x), double(d.z)), double(d.y));
        const int row = std::min(2 * height - 1, int(theta / kPiD * 2 * height));
        return row * 2 * width + std::min(2 * width - 1, int(u * 2 * width));
    }

  private:
    double cosine(int halfRow) const { return std::cos(kPiD * halfRow / (2 * height)); }
};

TEST(EnvironmentLight, DirectionsAgainstDensity) {
    for (const Map& map : maps()) {
        SCOPED_TRACE(map.name);
        const Environment environment(map.image, 1, map.rotation, map.name);
        const std::vector<PunctualLight> other{directionalLight({0, -1, 0}, Rgb(0.3f))};
        const Lights lights({}, other, {}, &environment, 1.0f);
        const double pmf = lights.pmf(1);
        ASSERT_EQ(lights.environmentIndex(), 1u);

        const TexelQuarters cells{map.image.width, map.image.height, map.rotation};
        std::vector<double> expected;
        double total = 0;
        for (int cell = 0; cell < cells.size(); ++cell) {
            expected.push_back(environment.pdfW(cells.centre(cell)) * cells.solidAngle(cell));
            total += expected.back();
        }
        EXPECT_NEAR(total, 1, 1e-5);

        constexpr int kSamples = 40'000;
        std::vector<std::uint64_t> counts(expected.size());
        std::uint64_t drawn = 0;
        int different = 0;
        Moments integral;
        for (unsigned i = 0; i < kSamples; ++i) {
            Rng rng(6, 0, StreamKind::User, i);
            const LightPoint p = lights.samplePoint(rng);
            if (p.kind != LightKind::Environment) continue;
            ++drawn;
            ++counts[std::size_t(cells.find(p.position))];
            integral.add(double(mean(environment.radiance(p.position))) * pmf / double(p.pdf));
            ASSERT_NEAR(length(Vec3d(p.position)), 1.0, 1e-6);
            const LightPoint q = lights.environmentPoint(p.position);
            ASSERT_EQ(q.exitance, p.exitance);
            // A direction at a texel's edge may fall into the next texel.
            different += std::abs(q.pdf - p.pdf) > 1e-5f * p.pdf;
        }
        EXPECT_LE(different, 2);
        EXPECT_GT(chiSquareSignificance(counts, expected, drawn), kSignificance);
        const SphereBins bins(Vec3{0, 1, 0}, 64, 64);
        double exact = 0;
        const auto radiance = [&](Vec3 d) { return double(mean(environment.radiance(d))); };
        for (const double m : bins.integrate(radiance, 8)) exact += m;
        EXPECT_NEAR(integral.mean(), exact, 4 * integral.standardError() + 2e-3 * exact);
    }
}

}  // namespace
}  // namespace lacuna::test
