// A pixel draws its eye path, its own light path and its picks by independent numbers. (A pick that
// knows its eye path's numbers is biased wherever the two agree on what is bright, and looks right
// everywhere else.)
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "libcore/bidir/integrator.h"
#include "tests/bidir/room.h"

namespace lacuna::test {
namespace {

constexpr int kColumns = 64, kLines = 48;

struct Column {
    const char* name;
    std::vector<double> values = std::vector<double>(std::size_t(kColumns) * kLines);
};

class OneSample final : public ConnectionDensity {
  public:
    double effectiveSamples(const Connection&) const override { return 1.0; }
};

/// Connects nothing and notes, for every pixel, where in it the eye path began, where its light
/// path began, and the numbers that picks at z_1 would be made by.
class NotesNumbers final : public Method {
  public:
    explicit NotesNumbers(const Camera& camera) : camera_(camera) {}
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }
    void select(const EyeContext& context, Rng& rng, ProposalSink&) const override {
        if (context.t() != 2) return;
        const std::uint32_t pixel = context.pixel;
        const auto seen =
            camera_.project(context.eyePath[0].position, -context.eyePath[1].toPrevious);
        ASSERT_TRUE(seen.has_value());
        eye[0].values[pixel] = double(seen->raster.x) - double(pixel % kColumns);
        eye[1].values[pixel] = double(seen->raster.y) - double(pixel / kColumns);
        const PathVertex& y0 = context.ownLightPath[0];
        light[0].values[pixel] = double(y0.light);
        light[1].values[pixel] = double(y0.lightUv.x);
        for (Column& c : picks) c.values[pixel] = double(rng.evenUniform());
    }

    mutable std::array<Column, 2> eye{{{"the eye path's x"}, {"the eye path's y"}}};
    mutable std::array<Column, 2> light{{{"the light path's lamp"}, {"the light path's point"}}};
    mutable std::array<Column, 6> picks{{{"the picks' number 1"},
                                         {"the picks' number 2"},
                                         {"the picks' number 3"},
                                         {"the picks' number 4"},
                                         {"the picks' number 5"},
                                         {"the picks' number 6"}}};

  private:
    const Camera& camera_;
    OneSample density_;
};

/// The correlation times the root of n: standard normal if the columns are independent.
double correlation(const Column& a, const Column& b) {
    const auto n = double(a.values.size());
    double meanA = 0, meanB = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        meanA += a.values[i] / n;
        meanB += b.values[i] / n;
    }
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        const double da = a.values[i] - meanA, db = b.values[i] - meanB;
        ab += da * db;
        aa += da * da;
        bb += db * db;
    }
    EXPECT_GT(aa, 0.0) << a.name << " is always the same";
    EXPECT_GT(bb, 0.0) << b.name << " is always the same";
    return ab / std::sqrt(aa * bb) * std::sqrt(n);
}

class Streams : public testing::TestWithParam<Sampling> {};

TEST_P(Streams, ofAPixelAreIndependent) {
    const auto scene = room(4);
    const Camera camera = scene->makeCamera("", {kColumns, kLines}, {});
    NotesNumbers method(camera);
    RenderSettings settings;
    settings.crop = {0, kColumns, 0, kLines};
    settings.sampling = GetParam();
    const ThreadPool threads(2);
    BidirIntegrator integrator(*scene, camera, {.connects = true, .ownLightPath = true}, method,
                               settings, threads);
    std::vector<Rgb> pixels(std::size_t(kColumns) * kLines);
    IterationStatistics statistics;
    ASSERT_TRUE(integrator.render(0, pixels, std::atomic<bool>(false), statistics));

    // False alarms: 28 pairs at 6 standard deviations, 6e-8.
    const auto expectIndependent = [](const auto& as, const auto& bs) {
        for (const Column& a : as) {
            for (const Column& b : bs) {
                EXPECT_LT(std::fabs(correlation(a, b)), 6.0) << a.name << " and " << b.name;
            }
        }
    };
    expectIndependent(method.eye, method.light);
    expectIndependent(method.eye, method.picks);
    expectIndependent(method.light, method.picks);
}
INSTANTIATE_TEST_SUITE_P(Samplings, Streams,
                         testing::Values(Sampling::Independent, Sampling::Sobol),
                         [](const auto& test) { return std::string(nameOf(test.param)); });

}  // namespace
}  // namespace lacuna::test
