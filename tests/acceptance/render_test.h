// Renders a scene with one row of the method table and compares pictures by z-tests.
//
// The significance of the tests: `kFalseAlarm` is the probability that one comparison of two pictures fails by chance
// (Sidak over its pixels, blocks and channels; Student's t over independent samples, with the smaller number of samples
// of the two). A program has a few hundred comparisons, so that one in about 10^4 changes of random numbers raises a
// false alarm. This requires scenes with moderate variance and renders that are long enough: no tiny light behind a
// mirror, no corner that is lit by unweighted connections.
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

/// The settings of a render: picture, length and method's parameters.
struct Shot {
    int width = 16, height = 16;
    int maxDepth = 5;
    int rouletteDepth = 3;
    PixelRect crop{};  ///< empty: the whole film
    Camera::Lens lens{};
    int iterations = 256;
    std::uint64_t seed = 1;
    Sampling sampling = Sampling::Independent;
    std::uint64_t lightPaths = 0;  ///< if the row has that parameter; 0: one per pixel
    float gain = 1;                ///< factor of pixels before they are compared
    int candidates = 0;            ///< likewise; 0: one light subpath per pixel
    double radius = 0.01;          ///< likewise; the blur of merging is invisible
    std::vector<std::string> settings = {};
    const ThreadPool* threads = nullptr;  ///< null: one thread, on which observers may rely
    std::uint64_t guide = 0;      ///< seed of a random emission guide for light paths; 0: none
    std::uint64_t walkGuide = 0;  ///< likewise for a guide of walks
    TechniqueFilm* techniques = nullptr;
    const PathLayers* layers = nullptr;  ///< layers for Picture::layers
    bool transparentBackground = false;  ///< adds A to Picture::layers
    GlassEffort glassEffort = {};
    PathObserver observer = nullptr;
};

/// 12 x 12 pixels, 512 light subpaths, paths of three edges: for tests that take tenths of a
/// second.
Shot quickShot(int iterations = 100);

/// Sums of one render: by pixel, and by blocks of 4 x 4 pixels if the size allows it.
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

/// The objects that must live as long as a render, for tests that drive the integrator themselves.
class Render {
  public:
    /// Makes the row's caches for the scene (scene_caches.h).
    Render(const Scene& scene, const MethodRow& row, const Shot& shot);
    /// Uses `method` (with its caches) and the techniques of `row`.
    Render(const Scene& scene, const MethodRow& row, const Shot& shot, Method& method);

    Picture run();
    BidirIntegrator& integrator() { return *integrator_; }
    const Camera& camera() const { return camera_; }
    /// Renders one iteration into pixels() and adds to the statistics.
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

/// Expects every pixel, every block and the mean of each channel to agree within the limits of
/// kFalseAlarm, and no sample to be invalid. Prints the smallest bias of the mean that would have
/// been detected.
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

/// The largest deviation in the comparisons of the running test, as a share of the allowed one; and
/// its unit for stabilityCase().
double worstDeviation();
inline constexpr const char* kOfAllowed = "of the deviation allowed";

// Rows
// ----------------------------------------------------------------------------------------------

/// The rows for every test of pictures: all except photon mapping. A few photons in a small radius
/// are too noisy to be compared; merging_test.cpp tests photon mapping.
std::vector<std::string> rowNames(Rows rows);
/// Those of them that have the technique with their default settings.
std::vector<std::string> rowNamesWith(bool (Techniques::*technique)() const, Rows rows);
/// The rows for tests of weights: they include photon mapping, and rows merge as they are set.
std::vector<std::string> rowNamesOfWeights();
MethodRow rowNamed(const std::string& name);
/// The reference of all rows of the running test, rendered only once, for the first row. `what` distinguishes the
/// test's references.
const Picture& renderedOnce(const std::string& what, const std::function<Picture()>& picture);
/// A test over rows by their names.
class RowTest : public testing::TestWithParam<std::string> {
  protected:
    MethodRow row() const { return rowNamed(GetParam()); }
    /// The path-traced picture of `builder`'s scene, by renderedOnce().
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

/// Whether the row can render what the lens sees through mirrors and smooth glass; splats alone
/// cannot.
bool seesThroughDeltas(const MethodRow& row);
/// `shot` with 32 light subpaths per pixel for a row with splats only. Light subpaths start
/// anywhere in the scene (those of a sky on a disk as wide), and few of them reach the surfaces
/// that one pixel sees. With one subpath per pixel, a pixel's variance is estimated from a handful
/// of splats, and a z-test is meaningless.
Shot withSplatsForEveryPixel(const Shot& shot, const MethodRow& row);
bool merges(const MethodRow& row);
/// Rows that merge only between deltas: in scenes without deltas they equal the rows without merging, bit for bit.
bool mergesBetweenDeltas(const MethodRow& row);
/// Rows whose light walks reach s >= 2: they render the caustics of lights that cannot be hit.
bool walksFromLights(const MethodRow& row);
bool isTestRow(const MethodRow& row);
/// The row without next-event estimation through glass; walks that hit lamps make these paths
/// instead.
MethodRow withoutRefractions(MethodRow row);
/// pt with lamps picked by power, as the reference for rows that pick lamps by sight.
const MethodRow& pathTracer();

}  // namespace lacuna::test
