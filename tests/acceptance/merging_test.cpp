// Merging on real paths. It is consistent, not unbiased: so pictures are compared at small radii, and the bias of large
// radii must be there and fall with the radius.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "libcore/bidir/verify.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

/// A floor below a slab of smooth glass, seen through it.
SceneBuilder underGlass() {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.7f, 0.6f, 0.5f));
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    b.add(box({-1.5f, 0.3f, -1.5f}, {1.5f, 0.4f, 1.5f}, b.add(glass())));
    b.add(lookAt({0, 1.6, 1.2}, {0, 0, 0}, 30));
    return b;
}

/// Long paths and a large pool, for what lies between two chains of glass.
Shot glassShot(int iterations) {
    Shot shot = quickShot(iterations);
    shot.maxDepth = 7;
    shot.candidates = 20'000;
    return shot;
}

/// A smooth ball of glass over a floor, under a lamp with a size: hits and merges find its caustic.
SceneBuilder ballCaustic() {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(quad({-1.5f, 0, 1.5f}, {3, 0, 0}, {0, 0, -3}));
    b.add(sphere({0, 0.55f, 0}, 0.4f, 24, b.add(glass()), true));
    b.add(quad({-0.5f, 2.2f, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add(emitter(Rgb(5.0f)))));
    b.add(lookAt({0.4, 1.2, 2.2}, {0, 0.15, 0}, 40));
    return b;
}

TEST(Merging, vcmMeetsBptOnACaustic) {
    const auto scene = ballCaustic().build();
    Shot shot = quickShot(150);
    shot.maxDepth = 6;
    const Picture merged = render(*scene, rowNamed("vcm"), shot);
    shot.seed = 101;
    shot.iterations = 400;
    expectSame(merged, render(*scene, rowNamed("bpt"), shot), "vcm on a caustic",
               Judge::BlocksAndMean);
}

/// Photon mapping has only merges and hits of the lamp for this.
TEST(MergingSlow, photonMappingMeetsBpt) {
    const auto scene = ballCaustic().build();
    Shot shot = quickShot(300);
    shot.maxDepth = 4;
    shot.radius = 0.02;
    shot.settings = {"photons=20000"};
    const Picture photons = render(*scene, rowNamed("ppm"), shot);
    shot.seed = 101;
    shot.settings = {};
    expectSame(photons, render(*scene, rowNamed("bpt"), shot), "photon mapping",
               Judge::BlocksAndMean);
}

/// A wall of polished metal in a lit room: one in thousands of the photons on it comes from within the eye's lobe.
TEST(Merging, photonMappingLooksIntoPolishedMetal) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.6f));
    b.add(box({-1, 0, -1}, {1, 2, 1}, 0, true));
    b.add(quad({-1, 0, -0.99f}, {2, 0, 0}, {0, 2, 0}, b.add(metal(Rgb(0.9f), 0.15f))));
    b.add(quad({-0.4f, 1.99f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}, b.add(emitter(Rgb(5.0f)))));
    b.add(lookAt({0, 0.9, 0.9}, {0, 0.7, -1}, 50));
    const auto scene = b.build();
    Shot shot = quickShot(20);
    shot.maxDepth = 4;
    shot.radius = 0.05;
    shot.settings = {"photons=20000"};
    const Picture photons = render(*scene, rowNamed("ppm"), shot);
    const auto isDark = [&](const Rgb& c) { return mean(c) < 0.2 * photons.mean(); };
    EXPECT_LT(std::ranges::count_if(photons.pixels.image().pixels, isDark), 7);
    shot.seed = 101;
    shot.iterations = 200;
    shot.settings = {};
    const Picture exact = render(*scene, rowNamed("bpt"), shot);
    const double error = std::hypot(photons.standardError(), exact.standardError());
    EXPECT_NEAR(photons.mean(), exact.mean(), 4.5 * error + 0.02 * exact.mean());
}

/// What SmallVCM shows: of a caustic under a point light, path tracing makes nothing, bidirectional path tracing what is
/// seen directly but nothing of what is seen in a mirror, and merging both. Specular chains make both without merging.
TEST(MergingSlow, causticsInMirrorsNeedMergesOrChains) {
    for (const bool reflected : {false, true}) {
        SCOPED_TRACE(reflected ? "in a mirror" : "directly");
        SceneBuilder b;
        b.d.materials[0] = matte(Rgb(0.6f));
        b.add(quad({-1.5f, 0, 1.5f}, {3, 0, 0}, {0, 0, -3}));
        b.add(sphere({0, 0.55f, 0}, 0.4f, 24, b.add(glass()), true));
        b.add(quad({-1.5f, 0, -1.4f}, {3, 0, 0}, {0, 2, 0}, b.add(mirror())));
        b.add(pointLight({0, 2.2, 0}, Rgb(2.0f)));
        // The caustic is around the origin; its image is as far behind the mirror.
        b.add(lookAt({1.2, 0.35, 0}, {0, 0, reflected ? -2.8 : 0.0}, 8));
        const auto scene = b.build();
        const auto picture = [&](const char* name, int iterations, bool chains) {
            Shot shot = quickShot(iterations);
            shot.maxDepth = 5;
            shot.radius = 0.03;  // the caustic is larger
            if (name == std::string("ppm")) shot.settings = {"photons=20000"};
            MethodRow row = rowNamed(name);
            if (!chains) row.techniques.chains = false;
            return render(*scene, row, shot);
        };
        const Picture merged = picture("ppm", 200, false);
        EXPECT_LT(picture("pt", 20, false).mean(), 0.5 * merged.mean());
        if (reflected) {
            EXPECT_LT(picture("bpt", 20, false).mean(), 0.5 * merged.mean());
        } else {
            expectSame(picture("bpt", 2000, false), merged, "bpt without chains", Judge::MeanOnly);
        }
        expectSame(picture("vcm", 2000, false), merged, "vcm", Judge::MeanOnly);
        for (const char* row : {"pt", "bpt"}) {
            expectSame(picture(row, 1000, true), merged, row, Judge::MeanOnly);
        }
    }
}

/// Rows that merge on demand make the same light as hits of a lamp with a size.
TEST(Merging, onDemandMeetsPathTracingUnderGlass) {
    SceneBuilder b = underGlass();
    b.add(quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, b.add(emitter(Rgb(2.0f)))));
    const auto scene = b.build();
    Shot shot = glassShot(100);
    const Picture merged = render(*scene, mergingRow("lvcbpt"), shot);
    shot.seed = 101;
    shot.iterations = 600;
    expectSame(merged, render(*scene, pathTracer(), shot), "lvcbpt merge=on", Judge::BlocksAndMean);
}

/// Under a sun no connection, hit or splat makes the floor's light: bpt is black there without its specular chains.
/// With them it agrees with all rows that merge.
TEST(Merging, makesWhatNothingElseDoes) {
    SceneBuilder b = underGlass();
    b.add(directionalLight({0.2, -1, 0.1}, Rgb(3.0f)));
    const auto scene = b.build();
    Shot shot = glassShot(40);
    shot.maxDepth = 6;
    MethodRow withoutChains = rowNamed("bpt");
    withoutChains.techniques.chains = false;
    const Picture joined = render(*scene, withoutChains, shot);
    const Picture chained = render(*scene, rowNamed("bpt"), shot);
    shot.settings = {"photons=20000"};
    const Picture photons = render(*scene, rowNamed("ppm"), shot);
    shot.settings = {};
    EXPECT_LT(joined.mean(), 0.05 * photons.mean());
    expectSame(chained, photons, "specular chains", Judge::MeanOnly);
    for (const std::string& row : rowsWithMerge()) {
        ++shot.seed;
        expectSame(render(*scene, mergingRow(row), shot), photons, row, Judge::MeanOnly);
    }
}

/// Where nothing scatters as a delta, merging on demand looks for no photons and changes no pixel.
TEST(Merging, onDemandIsNothingWithoutDeltas) {
    const auto scene = glossyBox().builder.build();
    for (const std::string& name : rowsWithMerge()) {
        Shot shot = quickShot(3);
        const Picture plain = render(*scene, rowNamed(name), shot);
        const Picture merging = render(*scene, mergingRow(name), shot);
        EXPECT_EQ(merging.statistics.held.count("photons"), 0u) << name;
        const Image a = plain.pixels.image(), b = merging.pixels.image();
        for (std::size_t i = 0; i < a.pixels.size(); ++i) {
            EXPECT_EQ(a.pixels[i], b.pixels[i]) << name << " " << i;
        }
    }
}

/// The bright half of a floor leaks into the dark one by the radius, and no further. So the bias of the dark half's
/// mean falls with the radius.
TEST(Merging, theBiasFallsWithTheRadius) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.8f));
    const auto black = b.add(matte(Rgb(0.0f)));
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    // A screen over the half x > 0 keeps the sun away; the camera is below it.
    b.add(quad({0, 1, -2}, {2, 0, 0}, {0, 0, 4}, black));
    b.add(directionalLight({0, -1, 0}, Rgb(1.0f)));
    b.add(lookAt({0.4, 0.9, 0}, {0.4, 0, 0}, 40, {0, 0, -1}));
    const auto scene = b.build();
    std::vector<double> means;
    for (const double radius : {0.4, 0.2, 0.1}) {
        Shot shot = quickShot(1);
        shot.maxDepth = 2;
        shot.radius = radius;
        shot.settings = {"photons=100000"};
        means.push_back(render(*scene, rowNamed("ppm"), shot).mean());
    }
    std::printf("    dark half's mean by radius: %.5f %.5f %.5f\n", means[0], means[1], means[2]);
    EXPECT_GT(means[0], 1e-3);
    EXPECT_LT(means[1], 0.75 * means[0]);
    EXPECT_LT(means[2], 0.75 * means[1]);
}

/// Photons on one face of a thin sheet are nearer than the radius to eye vertices on the other.
TEST(Merging, theOtherSideOfAThinSheetStaysDark) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.8f));
    b.add(box({-1, 0, -1}, {1, 0.01f, 1}));
    b.add(directionalLight({0, -1, 0}, Rgb(1.0f)));
    Shot shot = quickShot(2);
    shot.radius = 0.1;
    shot.settings = {"photons=20000"};
    for (const double y : {-1.0, 1.0}) {
        b.d.cameras.clear();
        b.add(lookAt({0, y, 0}, {0, 0, 0}, 40, {0, 0, -1}));
        const double mean = render(*b.build(), rowNamed("ppm"), shot).mean();
        EXPECT_EQ(mean > 0, y > 0) << mean;
    }
}

/// The radius of an iteration depends only on its number in the render.
TEST(Merging, theRadiusDependsOnTheIterationAlone) {
    const auto scene = ballCaustic().build();
    const MethodRow row = rowNamed("vcm");
    std::vector<double> samples;
    Shot shot = quickShot(1);
    shot.observer = [&](const PathEvent& event) { samples.push_back(event.counts.mergeSamples); };
    Render render(*scene, row, shot);
    render.warmUp();
    for (const std::uint32_t iteration : {0u, 255u, 0u}) {
        samples.clear();
        render.iterate(iteration);
        ASSERT_FALSE(samples.empty());
        const double shrunk = iteration == 255 ? 0.25 : 1.0;  // the radius halves
        EXPECT_NEAR(samples.front(), 144 * mergeArea(shot.radius) * shrunk, 1e-9);
    }
}

/// If no radius is set, it is two footprints of a pixel, here on a floor at a known distance.
TEST(Merging, theRadiusComesFromThePixels) {
    SceneBuilder b;
    b.add(quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}));
    b.add(quad({-1, 8, -1}, {2, 0, 0}, {0, 0, 2}, b.add(emitter(Rgb(2.0f)))));
    b.add(lookAt({0, 4, 0}, {0, 0, 0}, 10, {0, 0, -1}));
    const auto scene = b.build();
    const double footprint = 2 * 4 * std::tan(5 * std::numbers::pi / 180) / 12;
    double samples = 0;
    Shot shot = quickShot(1);
    shot.radius = 0;
    shot.observer = [&](const PathEvent& event) { samples = event.counts.mergeSamples; };
    render(*scene, rowNamed("vcm"), shot);
    EXPECT_NEAR(samples, 144 * mergeArea(2 * footprint), 0.02 * samples);
}

/// Paths of two edges merge at x_1, right under the light. Under lights of every kind their weights equal full products
/// (weights_test.cpp tests all other paths).
TEST(Merging, pathsOfTwoEdgesAreMergedAtTheirOnlyVertex) {
    for (int light = 0; light < kLightChoices; ++light) {
        SceneBuilder b = stage();
        addLight(b, LightChoice(light));
        const auto scene = b.build();
        Shot shot = quickShot(2);
        shot.maxDepth = 2;
        shot.radius = 0.2;
        std::atomic<int> merged = 0;
        std::atomic<bool> same = true;
        const Walker* walker = nullptr;
        shot.observer = [&](const PathEvent& event) {
            if (!event.technique.merges()) return;
            ++merged;
            const double again =
                misWeightByProducts(*walker, event.path, event.counts, event.technique);
            if (!(std::fabs(again - event.weight) < 1e-6)) same = false;
        };
        Render render(*scene, rowNamed("vcm"), shot);
        walker = &render.integrator().walker();
        render.warmUp();
        for (std::uint32_t i = 0; i < 2; ++i) render.iterate(i);
        EXPECT_GT(merged, 10) << nameOf(LightChoice(light));
        EXPECT_TRUE(same) << nameOf(LightChoice(light));
    }
}

}  // namespace
}  // namespace lacuna::test
