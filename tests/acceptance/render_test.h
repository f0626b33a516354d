// Renders a scene with one row of the method table and compares pictures by z-tests.
//
// What the tests state: `kFalseAlarm` is the probability that one comparison of two pictures fails
// by chance (Sidak over its pixels, blocks and channels; Student's t over independent samples, with
// the fewer ones of the two). A program has a few hundred comparisons, so one in about 10^4 changes of
// random numbers raises a false alarm. Scenes must keep samples tame enough for that, and renders
// be long enough: no tiny light behind a mirror, no corner that is lit by unweighted connections.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcore/bidir/integrator.h"
#include "libcore/methods/registry.h"
#include "tests/fixtures/test_rows.h"
#include "tests/material/statistics.h"
#include "tests/scene/scene_builder.h"

namespace lacuna::test {

inline constexpr double kFalseAlarm = 1e-6;

/// What is rendered and how long.
struct Shot {
    int width = 16, height = 16;
    int maxDepth = 5;
    int rouletteDepth = 3;
    PixelRect crop{};  ///< empty: the whole film
    Camera::Lens lens{};
    int iterations = 256;
    std::uint64_t seed = 1;
    Sampling sampling = Sampling::Independent;
    std::uint64_t lightPaths = 0;  ///< where the row has that parameter; 0: one per pixel
    float gain = 1;                ///< what pixels are multiplied by before they are judged
    int candidates = 0;            ///< likewise; 0: one light subpath per pixel
    double radius = 0.01;          ///< likewise: what merging then blurs no test here can see
    std::vector<std::string> settings = {};
    const ThreadPool* threads = nullptr;  ///< null: one, as observers may count on
    std::uint64_t guide = 0;  ///< seed of a random emission guide that light paths follow; 0: none
    std::uint64_t walkGuide = 0;  ///< likewise of a guide that walks follow
    TechniqueFilm* techniques = nullptr;
    const PathLayers* layers = nullptr;  ///< that Picture::layers has then
    bool transparentBackground = false;  ///< and A in Picture::layers
    GlassEffort glassEffort = {};
    PathObserver observer = nullptr;
};

/// 12 x 12 pixels, 512 light subpaths, paths of three edges: for tests of tenths of a second.
Shot quickShot(int iterations = 100);

/// Sums of one render: by pixel, and by blocks of 4 x 4 pixels where the size allows it.
struct Picture {
    explicit Picture(PixelRect crop, BlockPlan plan = {})
        : pixels(crop.width(), crop.height(), plan),
          blocks(std::max(1, crop.width() / 4), std::max(1, crop.height() / 4), plan) {}
    Film pixels, blocks;
    Layers layers;  ///< means
    IterationStatistics statistics;

    /// Mean of all pixels and channels, and its standard error.
    double mean() const;
    double standardError() const;
};

/// Everything that must live as long as a render; for tests that drive the integrator themselves.
class Render {
  public:
    /// The row's caches are made for the scene (scene_caches.h).
    Render(const Scene& scene, const MethodRow& row, const Shot& shot);
    /// With a method (and its caches) of one's own under the techniques of `row`.
    Render(const Scene& scene, const MethodRow& row, const Shot& shot, Method& method);

    Picture run();
    BidirIntegrator& integrator() { return *integrator_; }
    const Camera& camera() const { return camera_; }
    /// One iteration into pixels(); statistics are added up.
    void iterate(std::uint32_t iteration);
    void warmUp();
    std::span<const Rgb> pixels() const { return pixels_; }
    const IterationStatistics& statistics() const { return statistics_; }

  private:
    void start(const Scene& scene, const MethodRow& row, Method& method);

    Shot shot_;
    Camera camera_;
    Settings settings_;
    std::unique_ptr<Method> own_;
    Method* method_ = nullptr;
    std::optional<LayerFilm> layerFilm_;
    std::optional<CoverageFilm> coverage_;
    std::unique_ptr<BidirIntegrator> integrator_;
    std::vector<Rgb> pixels_;
    IterationStatistics statistics_;
};

Picture render(const Scene& scene, const MethodRow& row, const Shot& shot);

/// Every pixel, every block and the mean, each channel, within what kFalseAlarm allows. Also that
/// no sample was invalid. Prints the smallest bias of the mean that would have been seen.
enum class Judge { Everything, BlocksAndMean, MeanOnly };
void expectSame(const Picture& a, const Picture& b, const std::string& what,
                Judge judge = Judge::Everything);
/// The same against exact radiance.
void expectRadiance(const Picture& picture, const std::vector<Rgb>& exact, const std::string& what,
                    Judge judge = Judge::Everything);
void expectRadiance(const Picture& picture, double exact, const std::string& what,
                    Judge judge = Judge::Everything);

/// Radiance that arrives along a unit direction away from the camera.
using RadianceAlong = std::function<Vec3d(Vec3d direction)>;
/// Its mean over every pixel of the shot.
std::vector<Rgb> meanOverPixels(const Camera& camera, const Shot& shot,
                                const RadianceAlong& radiance);

/// The largest deviation that the comparisons above have met in the running test, as a share of
/// what each allowed; and what stabilityCase() calls that.
double worstDeviation();
inline constexpr const char* kOfAllowed = "of the deviation allowed";

// Rows
// ----------------------------------------------------------------------------------------------

/// Those that every test of pictures is for: photon mapping alone is left out. What few photons in a
/// small radius give is too noisy to judge, and merging_test.cpp is for the rest.
std::vector<std::string> rowNames(Rows rows);
/// Those of them that have it with the settings that they have unasked.
std::vector<std::string> rowNamesWith(bool (Techniques::*technique)() const, Rows rows);
/// With photon mapping, and all that merge as they are set: for tests of weights.
std::vector<std::string> rowNamesOfWeights();
MethodRow rowNamed(const std::string& name);
/// What all rows of the test that runs are judged by: rendered for the first of them alone. `what` tells its
/// pictures apart.
const Picture& renderedOnce(const std::string& what, const std::function<Picture()>& picture);
/// A test over rows by their names.
class RowTest : public testing::TestWithParam<std::string> {
  protected:
    MethodRow row() const { return rowNamed(GetParam()); }
    /// What path tracing makes of `builder`'s scene, renderedOnce().
    static const Picture& reference(const SceneBuilder& builder, const Shot& shot,
                                    const std::string& what = "");
};
std::string testName(const std::string& text);
/// For INSTANTIATE_TEST_SUITE_P: names a test after its parameter, as PrintTo writes it.
struct ByParameter {
    template <class T>
    std::string operator()(const testing::TestParamInfo<T>& test) const {
        return testName(testing::PrintToString(test.param));
    }
    std::string operator()(const testing::TestParamInfo<std::string>& test) const {
        return testName(test.param);
    }
};

/// Splats alone cannot make what the lens sees through mirrors and smooth glass.
bool seesThroughDeltas(const MethodRow& row);
/// `shot` with 32 light subpaths per pixel for a row of splats alone. Light subpaths start on all
/// of the scene (those of a sky: on a disk as wide) and few of them meet what one pixel sees; with
/// one subpath per pixel a pixel's variance is that of the handful of splats that it happened to
/// get, and a z-test means nothing.
Shot withSplatsForEveryPixel(const Shot& shot, const MethodRow& row);
bool merges(const MethodRow& row);
/// Rows that merge between deltas and nowhere else: without any they are what they are without merging, bit
/// for bit.
bool mergesBetweenDeltas(const MethodRow& row);
/// Rows whose light walks reach s >= 2: they make the caustics of lights that cannot be hit.
bool walksFromLights(const MethodRow& row);
bool isTestRow(const MethodRow& row);
/// What it leaves out is left to walks that run into lamps.
MethodRow withoutRefractions(MethodRow row);
/// pt, its lamps picked by power: what rows do that pick by sight is judged by what does not.
const MethodRow& pathTracer();

}  // namespace lacuna::test
