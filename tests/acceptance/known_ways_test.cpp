// Next event along known ways, to lamps with a size in mirrors and by reflections within glass: no light is lost or
// counted twice, and little of it is left to walks. (theory.md, "Next event along known ways")
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libcore/bidir/known_ways.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

/// The number of mirrors and surfaces of glass that light meets before something scatters it; zero if none of them
/// reflects it. What the lens sees of a lamp in a mirror is left to walks.
std::size_t lengthOfReflectedWay(const FullPath& path) {
    const int length = path.deltasBehindLight();
    for (int i = 1; i <= length; ++i) {
        if (path.vertex[std::size_t(i)]->event == ScatterEvent::DeltaReflection)
            return std::size_t(length);
    }
    return 0;
}
bool isReflected(const FullPath& path) {
    return lengthOfReflectedWay(path) > 0;
}

/// A floor with a mirror ball, and a matte ball in a block of glass. The lamp above is a square with this `side`; its
/// power does not depend on it.
std::shared_ptr<const Scene> mirrorAndBlock(float side, bool alpha = false) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.5f));
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    b.add(sphere({0.9f, 0.5f, -0.3f}, 0.5f, 24, b.add(mirror(Rgb(0.9f))), true));
    b.add(box({-0.5f, -0.3f, -0.5f}, {0.5f, 0.3f, 0.5f}, b.add(glass(1.4f))),
          translation({-0.7, 0.4, -0.1}) * rotation({1, 3, 1}, 20));
    b.add(sphere({-0.7f, 0.4f, -0.1f}, 0.2f, 8, b.add(matte({0.7f, 0.3f, 0.2f}))));
    lacuna::Material lamp = emitter(Rgb(4.0f / (side * side)), true);
    if (alpha) {
        lamp.alphaMode = lacuna::Material::Alpha::Blend;
        lamp.baseAlpha = 0.4f;
    }
    b.add(quad({0.6f, 1.8f, 0.4f}, {side, 0, 0}, {0, -0.2f * side, side}, b.add(lamp)));
    b.add(lookAt({0.2, 1.3, 3}, {0, 0.4, 0}, 40));
    return b.build();
}

struct Mean {
    double value, error;
};

/// A sum for each iteration.
class Sums {
  public:
    explicit Sums(std::uint64_t iterations) : sums_(iterations) {}

    void add(std::uint32_t iteration, double value) { sums_[iteration] += value; }
    /// Over iterations, with its standard error.
    Mean mean() const {
        double sum = 0, squares = 0;
        for (const double s : sums_) {
            sum += s;
            squares += s * s;
        }
        const auto n = double(sums_.size());
        return {sum / n, std::sqrt((squares / n - sum * sum / (n * n)) / (n - 1))};
    }

  private:
    std::vector<double> sums_;
};

/// The light that comes from the lamp by reflections: of all pixels, in an iteration.
Mean reflectedLight(const Scene& scene, const MethodRow& row, std::uint64_t iterations,
                    std::uint64_t seed, double effort = 1) {
    Shot shot;
    shot.glassEffort.knownWays = effort;
    shot.maxDepth = 7;
    shot.iterations = iterations;
    shot.seed = seed;
    Sums sums(iterations);
    shot.observer = [&](const PathEvent& event) {
        if (!isReflected(event.path)) return;
        sums.add(event.sample.iteration, double(mean(event.contribution)));
    };
    render(scene, row, shot);
    return sums.mean();
}

/// Compared with walks alone, which run into a lamp of this size. False alarms: one of 10^5 for each of three
/// comparisons.
TEST(KnownWays, areWhatWalksFind) {
    const auto scene = mirrorAndBlock(1.0f, true);
    const Mean walks = reflectedLight(*scene, withoutRefractions(rowNamed("pt")), 24000, 100);
    EXPECT_LT(walks.error, 0.02 * walks.value);
    for (const char* name : {"pt", "bpt"}) {
        const Mean known = reflectedLight(*scene, rowNamed(name), 4000, 1);
        EXPECT_LT(known.error, 0.02 * walks.value) << name;
        EXPECT_NEAR(known.value, walks.value, 4.4 * std::hypot(known.error, walks.error)) << name;
    }
    const Mean seldom = reflectedLight(*scene, rowNamed("pt"), 8000, 1, 0.1);
    EXPECT_LT(seldom.error, 0.04 * walks.value);
    EXPECT_NEAR(seldom.value, walks.value, 4.4 * std::hypot(seldom.error, walks.error));
}

/// Long chains come mostly from ways of which one is drawn at random. Unweighted, next event along them makes what
/// walks make of the same paths. False alarms: one of 10^5.
TEST(KnownWays, areDrawnAsOftenAsTheySay) {
    const auto scene = mirrorAndBlock(1.0f);
    Shot shot;
    shot.maxDepth = 9;
    shot.iterations = 20000;
    Sums known(shot.iterations), walks(shot.iterations);
    shot.observer = [&](const PathEvent& event) {
        if (!(event.path.refracted.ratio > 0) || lengthOfReflectedWay(event.path) < 5) return;
        Sums& sums = event.technique.refracts() ? known : walks;
        sums.add(event.sample.iteration, double(mean(event.contribution)) / event.weight);
    };
    render(*scene, rowNamed("pt"), shot);
    const Mean a = known.mean(), b = walks.mean();
    EXPECT_LT(std::hypot(a.error, b.error), 0.15 * b.value);
    EXPECT_NEAR(a.value, b.value, 4.4 * std::hypot(a.error, b.error));
}

/// The number of samples that a path counts as depends on the path alone, whichever technique made it.
TEST(KnownWays, countTheSameFromBothSides) {
    const auto scene = mirrorAndBlock(0.5f);
    for (const char* name : {"pt", "bpt"}) {
        Shot shot = quickShot(1500);
        shot.maxDepth = 7;
        shot.glassEffort.knownWays = 0.7;
        int own = 0, others = 0;
        double worst = 0;
        shot.observer = [&](const PathEvent& event) {
            const FullPath& path = event.path;
            if (!(path.refracted.ratio > 0) || !isReflected(path)) return;
            RayTally ignored;
            const double again = event.counts.knownWays->ratioOf(path, event.counts, ignored).ratio;
            worst = std::max(worst, std::fabs(again / path.refracted.ratio - 1));
            ++(event.technique.refracts() ? own : others);
        };
        render(*scene, rowNamed(name), shot);
        EXPECT_GT(own, 300) << name;
        EXPECT_GT(others, 10) << name;
        EXPECT_LT(worst, 1e-4) << name;
    }
}

/// Of the light that walks bring from the lamp by reflections, the technique could make most.
TEST(KnownWays, areMost) {
    const auto scene = mirrorAndBlock(0.3f);
    Shot shot = quickShot(3000);
    shot.maxDepth = 8;
    double known = 0, all = 0;
    shot.observer = [&](const PathEvent& event) {
        if (event.technique.refracts() || !isReflected(event.path)) return;
        const double light = double(mean(event.contribution)) / event.weight;
        all += light;
        if (event.path.refracted.ratio > 0) known += light;
    };
    render(*scene, rowNamed("pt"), shot);
    EXPECT_GT(known, 0.8 * all) << all;
}

/// The second moment of the light that comes from the lamp by reflections.
double secondMoment(const Scene& scene, const MethodRow& row) {
    Shot shot = quickShot(1000);
    shot.maxDepth = 7;
    double sum = 0;
    shot.observer = [&](const PathEvent& event) {
        const double value = double(mean(event.contribution));
        if (isReflected(event.path)) sum += value * value;
    };
    render(scene, row, shot);
    return sum;
}

/// The technique makes less noise where walks seldom run into a small lamp.
TEST(KnownWays, findWhatWalksMiss) {
    const auto scene = mirrorAndBlock(0.2f);
    for (const char* name : {"pt", "bpt"}) {
        const double with = secondMoment(*scene, rowNamed(name));
        const double without = secondMoment(*scene, withoutRefractions(rowNamed(name)));
        EXPECT_LT(with, 0.3 * without) << name;
    }
}

/// The camera lies in the plane of a lamp and looks at a wall there. By way of a mirror, rounding alone tells the
/// lamp's sides apart.
TEST(KnownWays, endNotAlongALampsOwnPlane) {
    SceneBuilder b;
    const auto white = b.add(matte(Rgb(0.5f)));
    b.add(box({-1, -2, -1}, {1, 0.02f, 1}, white, true));
    b.add(quad({0.99f, -2, 1}, {0, 0, -2}, {0, 2.01f, 0}, b.add(mirror(Rgb(0.9f)))));
    b.add(quad({-0.3f, 0, -0.4f}, {0.6f, 0, 0}, {0, 0, 0.8f}, b.add(emitter(Rgb(9)))));
    b.add(lookAt({-0.7, 0, 0.9}, {-0.7, 0, -1}, 1e-5));
    const auto scene = b.build();
    const Picture picture = render(*scene, rowNamed("pt"), quickShot(400));
    EXPECT_EQ(picture.statistics.invalidSamples, 0u);
    stabilityCase("lamp-edge-on", double(picture.statistics.invalidSamples), "invalid samples");
}

}  // namespace
}  // namespace lacuna::test
