// The first step of light subpaths: profiles and densities. False alarms: 1e-3 over all comparisons
// of this file.
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "libcore/scene/environment.h"
#include "libcore/scene/light.h"
#include "tests/base/chi_square.h"
#include "tests/scene/scene_builder.h"
#include "tests/scene/sphere_bins.h"

namespace lacuna::test {
namespace {

constexpr double kSignificance = 1e-3 / 16;  // Sidak of fewer than 16 comparisons

struct Source {
    const char* name;
    Lights lights;
    Vec3 axis;
    double zLow;  ///< cells cover directions of at least this cosine; nothing may leave elsewhere
    bool projected;
};

Lights areaLight(bool twoSided) {
    EmissiveTriangle t;
    t.corners = {Vec3{1, 0, 0}, Vec3{0, 2, 1}, Vec3{0, 0, 3}};
    t.radiance = {1, 2, 3};
    t.twoSided = twoSided;
    return Lights({t}, {}, {}, nullptr, 4.0f);
}
Lights punctual(const PunctualLight& l) {
    return Lights({}, std::vector<PunctualLight>{l}, Vec3d{1, 1, 1}, nullptr, 4.0f);
}

std::vector<Source> sources() {
    const Vec3 up = normalize(cross(Vec3{-1, 2, 1}, Vec3{-1, 0, 3}));
    const Vec3 axis = normalize(Vec3{1, -2, 2});
    const Vec3d d(axis);
    const auto spot = [&](double inner, double outer) {
        return punctual(spotLight({3, 2, 1}, d, Rgb(4, 2, 1), inner, outer));
    };
    std::vector<Source> s;
    s.push_back({"area, one side", areaLight(false), up, 0, true});
    s.push_back({"area, two sides", areaLight(true), up, -1, true});
    s.push_back({"point", punctual(pointLight({1, 2, 3}, Rgb(7.0f))), axis, -1, false});
    s.push_back({"spot", spot(0.3, 0.7), axis, std::cos(0.7), false});
    s.push_back({"spot, inner = outer", spot(0.5, 0.5), axis, std::cos(0.5), false});
    s.push_back({"spot, half space", spot(0, std::numbers::pi / 2), axis, 0, false});
    s.push_back({"spot, 0.01", spot(0.005, 0.01), axis, std::cos(0.01), false});
    s.push_back({"spot, 0.001", spot(0.0005, 0.001), axis, std::cos(0.001), false});
    s.push_back({"spot, 0.001, inner = outer", spot(0.001, 0.001), axis, std::cos(0.001), false});
    return s;
}

TEST(Emission, ProfileAndDensity) {
    for (const Source& source : sources()) {
        SCOPED_TRACE(source.name);
        const Lights& lights = source.lights;
        Rng first(1, 0, StreamKind::User, 0);
        const LightPoint point = lights.samplePoint(first);
        const SphereBins bins(source.axis, 12, 16, source.zLow);
        double profile = 0, density = 0;
        for (const double p : bins.integrate(
                 [&](Vec3 d) {
                     const double cosine = std::abs(dot(Vec3d(d), Vec3d(point.ng)));
                     return lights.emission(point, d, {}).profile * (source.projected ? cosine : 1);
                 },
                 16)) {
            profile += p;
        }
        const std::vector<double> mass =
            bins.integrate([&](Vec3 d) { return lights.emission(point, d, {}).pdfW; }, 16);
        for (const double m : mass) density += m;
        EXPECT_NEAR(profile, 1, 1e-3);
        EXPECT_NEAR(density, 1, 1e-3);

        constexpr int kSamples = 50'000;
        std::vector<std::uint64_t> counts(bins.size() + 1);
        int none = 0;
        for (unsigned i = 0; i < kSamples; ++i) {
            Rng rng(2, 0, StreamKind::User, i);
            const auto ray = lights.sampleEmission(point, rng);
            if (!ray) {
                ++none;
                continue;
            }
            ASSERT_EQ(ray->origin, point.position);
            ASSERT_NEAR(length(Vec3d(ray->direction)), 1, 1e-6);
            ASSERT_GT(ray->emission.pdfW, 0.0f);
            const Lights::Emission e = lights.emission(point, ray->direction, {});
            ASSERT_EQ(e.pdfW, ray->emission.pdfW);
            ASSERT_EQ(e.profile, ray->emission.profile);
            ++counts[bins.find(ray->direction)];
        }
        EXPECT_LE(none, 5);
        EXPECT_EQ(counts.back(), 0u);
        counts.pop_back();
        EXPECT_GT(chiSquareSignificance(counts, mass, kSamples), kSignificance);
    }
}

TEST(Emission, OneSideOnly) {
    const Lights one = areaLight(false), two = areaLight(true);
    Rng rng(3, 0, StreamKind::User, 0);
    const LightPoint p = one.samplePoint(rng), q = two.samplePoint(rng);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 d = randomDirection(rng);
        const Rgb front = p.exitance * one.emission(p, d, {}).profile;
        const Rgb both = q.exitance * two.emission(q, d, {}).profile;
        const bool out = dot(d, p.ng) > 0;
        EXPECT_NEAR(front.g, out ? 2.0f : 0.0f, 1e-6f);
        EXPECT_EQ(one.emission(p, d, {}).pdfW > 0, out);
        EXPECT_NEAR(both.g, 2.0f, 1e-6f);
        EXPECT_GT(two.emission(q, d, {}).pdfW, 0.0f);
    }
}

TEST(Emission, ExitanceTimesProfileIsWhatTheFileSays) {
    Rng rng(4, 0, StreamKind::User, 0);
    const Rgb intensity{4, 2, 1};
    const Lights point = punctual(pointLight({1, 2, 3}, intensity));
    const LightPoint p = point.samplePoint(rng);
    EXPECT_EQ(p.position, (Vec3{0, 1, 2}));  // the scene's centre is subtracted
    const Rgb seen = p.exitance * point.emission(p, {0, 1, 0}, {}).profile;
    EXPECT_NEAR(seen.r, 4, 1e-5);
    EXPECT_NEAR(seen.b, 1, 1e-5);

    for (const auto& [inner, outer] : {std::pair{0.2, 1.0},
                                       {0.6, 0.6},
                                       {0.0, std::numbers::pi / 2},
                                       {0.005, 0.01},
                                       {0.0005, 0.001},
                                       {0.0, 1e-4}}) {
        const Vec3d axis = normalize(Vec3d{1, -2, 2});
        const Lights spot = punctual(spotLight({}, axis, intensity, inner, outer));
        const LightPoint s = spot.samplePoint(rng);
        const Frame frame{Vec3(axis)};
        for (int i = 0; i <= 120; ++i) {
            const double angle = outer * i / 100, phi = i;
            const Vec3d d = Vec3d(frame.s) * (std::sin(angle) * std::cos(phi)) +
                            Vec3d(frame.t) * (std::sin(angle) * std::sin(phi)) +
                            axis * std::cos(angle);
            // Half-angle forms avoid cancellation.
            const auto versine = [](double a) { return 2 * std::pow(std::sin(a / 2), 2); };
            double falloff = angle < outer;
            if (angle > inner && angle < outer) {
                falloff = std::pow(
                    (versine(outer) - versine(angle)) / (versine(outer) - versine(inner)), 2);
            }
            const bool edge = std::abs(angle - outer) < 1e-3 * outer;
            const Rgb got = s.exitance * spot.emission(s, Vec3(d), {}).profile;
            if (edge) continue;
            EXPECT_NEAR(got.r, 4 * falloff, 0.01) << outer << " " << angle;
        }
    }
}

TEST(Emission, LightsAtInfinityCoverTheScene) {
    Image image(8, 4);
    Random random(7);
    for (Rgb& c : image.pixels) c = {random.next(), random.next(), random.next()};
    const Environment environment(image, 1, 20, "noise");
    constexpr float kRadius = 50;
    Rng rng(5, 0, StreamKind::User, 0);
    constexpr int kSamples = 50'000;
    std::vector<std::uint64_t> counts(64);
    for (int i = 0; i < kSamples; ++i) {
        const Vec3 direction = randomDirection(rng);
        std::vector<PunctualLight> sun;
        sun.push_back(directionalLight(Vec3d(direction), Rgb(2, 3, 4)));
        const Lights lights = i % 100 == 0 ? Lights({}, sun, {}, nullptr, kRadius)
                                           : Lights({}, {}, {}, &environment, kRadius);
        ASSERT_GE(lights.diskRadius(), kRadius);
        const LightPoint p = lights.samplePoint(rng);
        const auto ray = lights.sampleEmission(p, rng);
        ASSERT_TRUE(ray);
        ASSERT_EQ(ray->direction, -p.position);
        const double disk = lights.diskRadius();
        EXPECT_NEAR(ray->emission.pdfW * std::numbers::pi * disk * disk, 1, 1e-5);
        EXPECT_EQ(ray->emission.profile, 1.0f);
        if (p.kind == LightKind::Directional) {
            ASSERT_LT(length(ray->direction - direction), 1e-6f);
            ASSERT_EQ(p.exitance, Rgb(2, 3, 4));
        } else {
            ASSERT_EQ(p.exitance, environment.radiance(p.position));
        }
        // The ray starts before the sphere and covers the sphere's shadow uniformly.
        const Vec3d origin(ray->origin), to(ray->direction);
        ASSERT_GE(-dot(origin, to), kRadius * (1 - 1e-6));
        const Vec3d across = origin - to * dot(origin, to);
        const double r2 = lengthSquared(across) / (disk * disk);
        ASSERT_LE(r2, 1 + 1e-5);
        const Frame frame(p.position);
        const double turn = std::atan2(dot(across, Vec3d(frame.t)), dot(across, Vec3d(frame.s)));
        ++counts[std::min(7u, unsigned(r2 * 8)) * 8 +
                 std::min(7u, unsigned((turn / (2 * std::numbers::pi) + 0.5) * 8))];
    }
    EXPECT_GT(chiSquareSignificance(counts, std::vector<double>(64, 1.0 / 64), kSamples),
              kSignificance);
}

}  // namespace
}  // namespace lacuna::test
