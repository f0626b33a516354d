// Guided emission: points and rays have the densities that emission() returns, for any guide. False alarms: 1e-6 for
// each comparison.
#include "libcore/scene/emission_guide.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "libcore/scene/environment.h"
#include "tests/base/chi_square.h"
#include "tests/fixtures/random_guide.h"
#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

/// A sky of 16 x 8 texels, some of them black.
Image patchySky() {
    Image image(16, 8);
    Rng rng(9, 0, StreamKind::User, 0);
    for (Rgb& c : image.pixels) c = rng.below(3) == 0 ? Rgb{} : Rgb(0.1f + 5.0f * rng.uniform());
    return image;
}

/// Lights of all kinds; the scene's radius is 4.
struct AllKinds {
    Environment sky{patchySky(), 1.0, 30.0, "sky"};
    Lights lights = make();

    Lights make() const {
        std::vector<EmissiveTriangle> triangles(3);
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            EmissiveTriangle& t = triangles[i];
            t.corners = {Vec3{1, 0, float(i)}, Vec3{0, 2, 1}, Vec3{0, 0, 3}};
            t.radiance = Rgb(40.0f * (1.0f + float(i)));
            t.twoSided = i == 1;
        }
        triangles[2].corners = {Vec3{0, 1, 1}, Vec3{0, 2, 1}, Vec3{0, 1, 2}};  // an upright wall
        const std::vector<PunctualLight> punctual = {
            pointLight({1, 2, 3}, Rgb(20.0f)),
            spotLight({3, 2, 1}, normalize(Vec3d{1, -2, 2}), Rgb(200.0f), 0.3, 0.7),
            directionalLight(normalize(Vec3d{1, -2, 0.5}), Rgb(4.0f))};
        return Lights(triangles, punctual, {}, &sky, 4.0f);
    }
};

/// A point where rays at infinity arrive: any that they pass.
Vec3 arrival(const Lights::EmissionRay& ray) {
    return ray.origin + ray.direction * 3.0f;
}

TEST(EmissionGuide, SquaresAreThoseThatPlainEmissionFillsEvenly) {
    const AllKinds all;
    const Lights& lights = all.lights;
    constexpr int kDraws = 200'000, kCells = 8;
    std::vector<std::vector<std::uint64_t>> points(lights.size()), rays(lights.size());
    for (auto* counts : {&points, &rays}) {
        for (auto& c : *counts) c.assign(kCells * kCells, 0);
    }
    const auto cellOf = [&](SquarePoint p) {
        const auto slot = [](double x) {
            return std::min(std::size_t(x * kCells), std::size_t(kCells - 1));
        };
        return slot(p[1]) * kCells + slot(p[0]);
    };
    for (unsigned i = 0; i < kDraws; ++i) {
        Rng rng(1, 0, StreamKind::User, i);
        const LightPoint p = lights.samplePoint(rng);
        const auto ray = lights.sampleEmission(p, rng);
        ASSERT_TRUE(ray);
        ++points[p.light][cellOf(lights.pointSquare(p))];
        ++rays[p.light][cellOf(lights.raySquare(p, ray->direction, arrival(*ray)))];
    }
    const std::vector<double> even(kCells * kCells, 1.0 / (kCells * kCells));
    for (std::uint32_t l = 0; l < lights.size(); ++l) {
        SCOPED_TRACE(l);
        std::uint64_t n = 0;
        for (const std::uint64_t c : rays[l]) n += c;
        EXPECT_GT(n, 2000u);
        EXPECT_GT(chiSquareSignificance(rays[l], even, n), 1e-6);
        if (isHittable(lights.kind(l))) {
            EXPECT_GT(chiSquareSignificance(points[l], even, n), 1e-6);
        }
    }
}

/// Guided draws, weighted by plain over guided density, are distributed as plain ones: all of them together, and in
/// each quarter of the rays' square.
TEST(EmissionGuide, DensitiesAreOnesThatDrawsHave) {
    const AllKinds all;
    const Lights& plain = all.lights;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const Lights guided = plain.guidedBy(randomGuide(plain, seed));
        constexpr int kDraws = 200'000;
        std::vector<std::uint64_t> counts(plain.size());
        std::array<double, 5> sums{}, squares{};  // of all rays; by quarter of their square
        for (unsigned draw = 0; draw < kDraws; ++draw) {
            Rng rng(seed, 0, StreamKind::User, draw);
            const LightPoint p = guided.samplePoint(rng);
            const auto ray = guided.sampleEmission(p, rng);
            ASSERT_TRUE(ray);
            ++counts[p.light];
            const Vec3 x1 = arrival(*ray);
            const Lights::Emission told = guided.emission(p, ray->direction, x1);
            EXPECT_NEAR(told.pdfW, ray->emission.pdfW, 1e-5 * told.pdfW) << p.light;
            const Lights::GuidedPdfs pdfs = guided.guidedPdfs(p, ray->direction, x1);
            const Lights::Emission asPlain = plain.emission(p, ray->direction, x1);
            EXPECT_NEAR(told.pdfW, double(asPlain.pdfW) * pdfs.ray, 1e-5 * told.pdfW);
            const double ratio = 1.0 / (double(pdfs.point) * double(pdfs.ray));
            const SquarePoint at = plain.raySquare(p, ray->direction, x1);
            for (const std::size_t i : {0u, 1u + (at[0] < 0.5) + 2u * (at[1] < 0.5)}) {
                sums[i] += ratio;
                squares[i] += ratio * ratio;
            }
        }
        for (std::size_t i = 0; i < sums.size(); ++i) {
            const double mean = sums[i] / kDraws;
            const double error = std::sqrt((squares[i] / kDraws - mean * mean) / kDraws);
            EXPECT_NEAR(mean, i == 0 ? 1.0 : 0.25, 5 * error) << "seed " << seed << " " << i;
        }
        std::vector<double> pmf;
        for (std::uint32_t l = 0; l < plain.size(); ++l) pmf.push_back(guided.pmf(l));
        EXPECT_GT(chiSquareSignificance(counts, pmf, kDraws), 1e-6) << "seed " << seed;
    }
}

/// A hit asks for the density of a point that a light walk may have drawn.
TEST(EmissionGuide, AHitFindsTheDensityOfTheDraw) {
    const AllKinds all;
    const Lights guided = all.lights.guidedBy(randomGuide(all.lights, 5));
    for (unsigned i = 0; i < 5000; ++i) {
        Rng rng(1, 0, StreamKind::User, i);
        const LightPoint p = guided.samplePoint(rng);
        if (p.kind == LightKind::Area) {
            EXPECT_EQ(guided.areaPoint(p.light, p.position, p.ng, p.uv).pdf, p.pdf);
        }
        if (p.kind == LightKind::Environment) {
            EXPECT_NEAR(guided.environmentPoint(p.position).pdf, p.pdf, 1e-4 * p.pdf);
        }
    }
}

TEST(EmissionGuide, RefusesWhatDoesNotFit) {
    const AllKinds all;
    const auto good = randomGuide(all.lights, 1);
    const auto refused = [&](const char* what, const auto& spoil) {
        EmissionGuide g = *good;
        spoil(g);
        EXPECT_THROW(g.check(all.lights.size()), std::invalid_argument) << what;
    };
    EXPECT_NO_THROW(good->check(all.lights.size()));
    refused("another scene", [](EmissionGuide& g) { g.pmf.pop_back(), g.pointTree.pop_back(); });
    refused("sum", [](EmissionGuide& g) { g.pmf[0] += 0.1; });
    refused("no number", [](EmissionGuide& g) { g.pmf[0] = std::nan(""); });
    refused("no such tree", [](EmissionGuide& g) { g.pointTree[0] = 1000; });
    refused("no such rays", [](EmissionGuide& g) { g.rayTree[0] = 1000; });
    refused("a leaf without rays", [](EmissionGuide& g) { g.rayTree.pop_back(); });
    EmissionGuide other = *good;
    other.pmf[0] += 1e-12;
    EXPECT_NE(other.contentHash(), good->contentHash());
}

}  // namespace
}  // namespace lacuna::test
