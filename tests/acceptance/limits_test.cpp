// Limits: each scene is so extreme that something simpler is left, for which the truth is known.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

class Limits : public RowTest {
  protected:
    /// Compares this row with path tracing.
    void expectReference(const SceneBuilder& builder, Shot shot, const std::string& what) const {
        const Picture p = render(*builder.build(), row(), shot);
        shot.seed += 100;
        expectSame(p, reference(builder, shot, what), row().name + ", " + what,
                   Judge::BlocksAndMean);
    }
};
INSTANTIATE_TEST_SUITE_P(All, Limits, testing::ValuesIn(rowNames(Rows::OfTheTool)), ByParameter());
INSTANTIATE_TEST_SUITE_P(Night, Limits, testing::ValuesIn(rowNames(Rows::OfTests)), ByParameter());

// Materials
// ----------------------------------------------------------------------------------------

/// The mean of every strategy's weighted picture, at [edges][t], over batches.
std::vector<std::vector<Moments>> strategyMeans(const Scene& scene, const MethodRow& row, Shot shot,
                                                int batches) {
    const auto n = std::size_t(shot.maxDepth) + 2;
    std::vector<std::vector<Moments>> means(n, std::vector<Moments>(n));
    for (int batch = 0; batch < batches; ++batch) {
        TechniqueFilm film(shot.width, shot.height, shot.maxDepth);
        shot.techniques = &film;
        EXPECT_EQ(render(scene, row, shot).statistics.invalidSamples, 0u);
        ++shot.seed;
        for (int k = 1; k <= shot.maxDepth; ++k) {
            for (int t = 1; t <= k + 1; ++t) {
                double sum = 0;
                for (const Rgb& c : film.weighted(k + 1 - t, t).pixels) {
                    sum += double(lacuna::mean(c));
                }
                means[std::size_t(k)][std::size_t(t)].add(sum / (shot.width * shot.height));
            }
        }
    }
    return means;
}

/// A delta is the limit of a narrow lobe, strategy by strategy. If every delta had a density of 1, the pictures would
/// agree, too, but the shares of the strategies would jump.
TEST(DeltaShares, meetThoseOfANarrowLobe) {
    // By bpt: other methods' densities depend on the pool, which has no vertices on deltas. Without next event along
    // known ways, which goes over deltas alone.
    const MethodRow row = withoutRefractions(rowNamed("bpt"));
    // Ten times the usual size, so that densities per area are far from 1.
    const Affine place = scaling({10, 10, 10});
    const auto withMirror = [&](float roughness) {
        SceneBuilder b;
        const auto mirror = b.add(metal(Rgb(0.9f), roughness));
        b.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), place);
        b.add(quad({1, 0, -0.8f}, {0, 0, 1.8f}, {0, 1.4f, 0}), place);
        b.add(quad({-0.9f, 0, -0.8f}, {1.8f, 0, 0}, {0, 1.4f, 0}, mirror), place);
        b.add(quad({-0.5f, 1.6f, -0.4f}, {1, 0, 0}, {0, 0, 0.8f}, b.add(emitter(Rgb(3.0f)))),
              place);
        b.add(lookAt({0, 10, 26}, {0, 3, -1}, 34));
        return b.build();
    };
    Shot shot;
    shot.width = shot.height = 12;
    shot.maxDepth = 4;
    shot.iterations = 12;
    shot.lightPaths = 512;
    constexpr int kBatches = 40;
    // First an alpha just above what counts as a delta, then a delta.
    const auto rough = strategyMeans(*withMirror(0.0100001f), row, shot, kBatches);
    shot.seed = 1001;
    const auto delta = strategyMeans(*withMirror(0), row, shot, kBatches);
    double worst = 0;
    for (std::size_t k = 2; k <= std::size_t(shot.maxDepth); ++k) {  // the lamp is out of view
        double total = 0;
        for (std::size_t t = 1; t <= k + 1; ++t) total += delta[k][t].mean();
        ASSERT_GT(total, 0);
        for (std::size_t t = 1; t <= k + 1; ++t) {
            const Moments &a = rough[k][t], &b = delta[k][t];
            // 5.5 standard errors with 78 degrees of freedom: 5e-7. What a lobe of finite width
            // moves to strategies that a delta does not have is below a thousandth.
            const double allowed =
                5.5 * std::hypot(a.standardError(), b.standardError()) + 1e-3 * total;
            EXPECT_NEAR(a.mean(), b.mean(), allowed)
                << row.name << ", s = " << k + 1 - t << ", t = " << t << " of " << total;
            worst = std::max(worst, std::fabs(a.mean() - b.mean()) / allowed);
        }
    }
    stabilityCase("delta-shares", worst, kOfAllowed);
}

TEST_P(Limits, shadingNormalsBentHard) {
    const SceneBuilder b = bentNormals().builder;
    Shot shot = quickShot(80);
    shot.maxDepth = 4;
    expectReference(b, shot, "bent normals");
    stabilityCase("bent-normals", worstDeviation(), kOfAllowed);
}

TEST_P(Limits, lightInsideGlass) {
    SceneBuilder b;
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    // Rough, so that not only hits make its paths, but also splats and connections.
    b.add(sphere({0, 0.6f, 0}, 0.5f, 12, b.add(glass(1.5f, 0.6f)), true));
    b.add(sphere({0, 0.6f, 0}, 0.25f, 8, b.add(emitter(Rgb(4.0f)))));
    b.add(lookAt({0, 1.4, 2.6}, {0, 0.4, 0}, 38));
    Shot shot = quickShot(80);
    shot.maxDepth = 4;
    expectReference(b, shot, "light inside glass");
    stabilityCase("light-in-glass", worstDeviation(), kOfAllowed);
}

// Sizes
// --------------------------------------------------------------------------------------------

/// An absolute length anywhere in the code, however small, would change some bit. Where methods take their light from
/// the pool (the papers' presets), it may lie at infinity.
TEST_P(Limits, powersOfTwoInSizeChangeNoBit) {
    if (isTestRow(row())) GTEST_SKIP() << "has cells, nodes or trees at places of its own";
    std::vector<std::vector<std::string>> settings{{}};
    if (!row().paper.empty()) settings.push_back({"preset=paper"});
    std::size_t different = 0;
    for (const std::vector<std::string>& assignments : settings) {
        std::vector<Rgb> first;
        for (const double scale : {1.0, 0x1p-10, 0x1p20}) {
            SceneBuilder b = glossyBox().builder;
            b.d.instances.erase(b.d.instances.begin() + 3);  // the wall behind the camera
            for (lacuna::Material& m : b.d.materials) m.emission *= float(1 / (scale * scale));
            for (Instance& i : b.d.instances) {
                i.toWorld = scaling({scale, scale, scale}) * i.toWorld;
            }
            b.add(directionalLight({0.3, -0.2, -1}, Rgb(float(0.8 / (scale * scale)))));
            b.d.cameras.clear();
            b.add(lookAt({0, 0, 0.98 * scale}, {0, -0.1 * scale, 0}, 75));
            const auto scene = b.build();
            Shot shot = quickShot();
            shot.maxDepth = 5;
            shot.settings = assignments;
            shot.radius = 0;  // from the pixels, which grow with the scene
            Render render(*scene, row(), shot);
            render.warmUp();
            for (std::uint32_t i = 0; i < 3; ++i) {
                render.iterate(i);
                const std::size_t begin = i * render.pixels().size();
                for (std::size_t p = 0; p < render.pixels().size(); ++p) {
                    const Rgb c = render.pixels()[p] * float(scale * scale);
                    if (scale == 1.0) first.push_back(c);
                    different += !(c == first[begin + p]);
                }
            }
            EXPECT_EQ(render.statistics().invalidSamples, 0u) << scale;
        }
        EXPECT_EQ(different, 0u) << row().name << (assignments.empty() ? "" : ", preset=paper");
    }
    stabilityCase("scale", double(different), "pixels differ in a bit");
}

/// The camera is between two plates a ten-thousandth apart. One plate shines, and the other one sees nothing else.
TEST_P(Limits, betweenPlatesATenThousandthApart) {
    if (!seesThroughDeltas(row())) GTEST_SKIP() << "splats do not meet a film of 1e-4";
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
    b.add(quad({-1, 1e-4f, -1}, {2, 0, 0}, {0, 0, 2}, b.add(emitter(Rgb(2.0f)))));
    b.add(lookAt({0, 5e-5, 0}, {3e-5, 0, 0}, 40));
    Shot shot = quickShot(60);
    shot.maxDepth = 2;
    // The form factor of a quad of side 2 from 1e-4 away is 1 - 1e-8.
    expectRadiance(render(*b.build(), row(), shot), 1.2, row().name + ", between plates");
    stabilityCase("light-near-surface", worstDeviation(), kOfAllowed);
}

TEST_P(Limits, lightAMillionTimesTheScene) {
    if (!seesThroughDeltas(row())) GTEST_SKIP() << "a light subpath meets the floor once in 1e12";
    if (isTestRow(row())) GTEST_SKIP() << "believes in a connection that succeeds once in 1e12";
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}));
    b.add(quad({-1e6f, 2, -1e6f}, {2e6f, 0, 0}, {0, 0, 2e6f}, b.add(emitter(Rgb(2.0f)))));
    b.add(lookAt({0, 0.9, 0.8}, {0, 0, 0}, 40));
    Shot shot = quickShot(60);
    shot.maxDepth = 2;
    expectRadiance(render(*b.build(), row(), shot), 1.2, row().name + ", huge light");
    stabilityCase("huge-light", worstDeviation(), kOfAllowed);
}

/// The film shows about a thousandth of a unit where three walls of the furnace meet. Connections within that corner
/// are shorter still.
TEST_P(Limits, cornerOfTheFurnace) {
    if (!seesThroughDeltas(row())) GTEST_SKIP() << "splats do not meet so narrow a film";
    SceneBuilder b;
    b.d.materials[0] = emitter(Rgb(0.5f), false, Rgb(0.5f));
    b.add(box({-1, -1, -1}, {1, 1, 1}, 0, true));
    b.add(lookAt({0.3, 0.2, 0.4}, {1, 1, -1}, 0.05));
    Shot shot = quickShot(80);
    shot.maxDepth = 4;
    expectRadiance(render(*b.build(), row(), shot), 1 - std::pow(0.5, 4), row().name + ", corner");
    stabilityCase("corner", worstDeviation(), kOfAllowed);
}

// Film, lens, iterations
// -----------------------------------------------------------------------------------------------

/// Each pixel shows a luminous quad by the part of the pixel that it covers, for hits and for splats.
TEST_P(Limits, edgesOfALightCoverPartsOfPixels) {
    SceneBuilder b;
    b.add(quad({-3.6f, -2.5f, 0}, {6.1f, 0, 0}, {0, 6, 0}, b.add(emitter(Rgb(2.0f)))));
    b.add(lookAt({0, 0, 10}, {0, 0, 0}, 2 * std::atan(0.6) * 180 / std::numbers::pi));
    Shot shot = quickShot(150);  // 12 x 12 pixels of size 1
    shot.maxDepth = 1;
    const auto covered = [](double low, double high, double from) {
        return std::clamp(std::min(high, from + 1) - std::max(low, from), 0.0, 1.0);
    };
    std::vector<Rgb> exact;
    for (int y = 0; y < 12; ++y) {
        for (int x = 0; x < 12; ++x) {
            exact.push_back(Rgb(float(2 * covered(-3.6, 2.5, x - 6) * covered(-2.5, 3.5, 5 - y))));
        }
    }
    expectRadiance(render(*b.build(), row(), shot), exact, row().name + ", edges of a light");
    stabilityCase("pixel-filter", worstDeviation(), kOfAllowed);
}

/// A blind over one half of a wide lens takes one half of the light.
TEST_P(Limits, halfBlockedLens) {
    constexpr double kRadius = 0.2, kFocus = 3, kAway = 0.01;
    SceneBuilder b;
    b.d.materials[0] = emitter(Rgb(1.0f));
    b.add(box({-1, -1, -1}, {1, 1, 1}, 0, true));
    b.add(quad({0, -0.5f, float(0.9 - kAway)}, {0.9f, 0, 0}, {0, 1, 0}, b.add(matte(Rgb(0.0f)))));
    b.add(lookAt({0, 0, 0.9}, {0, 0, 0}, 40));
    Shot shot = quickShot(150);
    shot.maxDepth = 1;
    shot.lens = {float(kRadius), float(kFocus)};
    shot.lightPaths = 2048;
    std::vector<Rgb> exact;
    for (int i = 0; i < shot.width * shot.height; ++i) {
        // The ray from lens point x towards (u, v, 1) in focus passes the blind's plane at x (1 - away / focus) + u
        // away. It is free where that is below 0. This is all but linear over a pixel.
        const double u =
            (2.0 * (i % shot.width + 0.5) / shot.width - 1) * std::tan(20 * std::numbers::pi / 180);
        const double c = -u * kAway / (1 - kAway / kFocus) / kRadius;
        exact.push_back(
            Rgb(float(0.5 + (c * std::sqrt(1 - c * c) + std::asin(c)) / std::numbers::pi)));
    }
    expectRadiance(render(*b.build(), row(), shot), exact, row().name + ", half a lens");
    stabilityCase("half-lens", worstDeviation(), kOfAllowed);
}

/// The furnace's mean over many renders of 1, some of 4 and one of 64 iterations.
TEST_P(Limits, iterationsChangeNoMean) {
    SceneBuilder b;
    b.d.materials[0] = emitter(Rgb(0.5f), false, Rgb(0.5f));
    b.add(box({-1, -1, -1}, {1, 1, 1}, 0, true));
    b.add(lookAt({0, 0, 0.9}, {0, 0, -1}, 70));
    const auto scene = b.build();
    Shot shot = quickShot();
    shot.width = shot.height = 8;
    shot.lightPaths = 64;
    double worst = 0;
    for (const int iterations : {1, 4, 64}) {
        Moments means;
        Picture last({0, 8, 0, 8});
        for (int i = 0; i < 64 / iterations; ++i) {
            shot.iterations = iterations;
            ++shot.seed;
            // Without the scene's caches, which each of the 81 renders would make anew.
            std::vector<std::string> settings = smallSettings(row(), 64);
            for (const Option& o : row().options) {
                if (o.name == "radius") settings.push_back("radius=0.01");
            }
            const auto method = row().create(resolve(row(), settings));
            last = Render(*scene, row(), shot, *method).run();
            EXPECT_EQ(last.statistics.invalidSamples, 0u);
            means.add(last.mean());
        }
        const double error = iterations == 64 ? last.standardError() : means.standardError();
        // 5 standard errors that 16 or more samples estimate: up to 8.3 by Student's t, 6e-7.
        const double allowed = studentQuantile(5, iterations == 4 ? 15 : 63) * error + 1e-5;
        EXPECT_NEAR(means.mean(), 0.875, allowed) << row().name << ", " << iterations;
        worst = std::max(worst, std::fabs(means.mean() - 0.875) / allowed);
    }
    stabilityCase("iterations", worst, kOfAllowed);
}

}  // namespace
}  // namespace lacuna::test
