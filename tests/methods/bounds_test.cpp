// A connection never counts as more samples than there are light subpaths, however many picks there
// are and however bright its light vertex is.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "libcore/base/parallel.h"
#include "libcore/methods/registry.h"
#include "libcore/resampling/picks.h"
#include "tests/fixtures/beliefs.h"
#include "tests/fixtures/fixed_eye_path.h"
#include "tests/fixtures/test_rows.h"

namespace lacuna::test {
namespace {

constexpr int kManySubpaths = 80;  // more than picks
constexpr double kLittle = 1e-3;

/// A surface at the origin that every light vertex reaches with its whole throughput.
class SurfaceInSight final : public FixedEyePath {
  public:
    SurfaceInSight() {
        Bsdf::Parameters grey;
        grey.baseColor = Rgb(0.5f);
        addLens({0, 1, 2});
        addSurface({0, 0, 0}, grey);
    }
    Arrival arrival(Subpath light, Subpath, bool) const override {
        const Rgb all = light.back().throughput;
        return {all, all, kLittle};
    }
};

/// The samples that the weights count for connections with a y_1 of these throughputs, with as many
/// picks as the options allow.
std::vector<double> believedSamples(const MethodRow& row, const std::vector<std::string>& more,
                                    const std::vector<float>& throughputs, Label light) {
    const LightPool pool = poolOfPairs(kManySubpaths, [](int i, PathVertex& y) {
        y.position = {0.1f * float(i % 9), 0.1f * float(i / 9), 1.5f};
        y.throughput = Rgb(1.0f + 0.1f * float(i));
    });
    const SurfaceInSight space;
    const ThreadPool threads(1);
    IterationStatistics statistics;
    IterationContext context{space, threads, 43, 0, 1, statistics};
    std::vector<std::string> settings = {"candidates=" + std::to_string(kManySubpaths),
                                         "connections=" + std::to_string(Picks::kMost)};
    for (const Option& o : row.options) {
        if (o.name == "cache_density" || o.name == "record_density") {
            settings.push_back(o.name + "=1");
        }
    }
    settings.insert(settings.end(), more.begin(), more.end());
    const auto method = row.create(resolve(row, settings));
    const ConnectionDensity& density = settle(*method, pool, context, 3);
    const Subpath eye = space.eye();
    const Subpath y = pool.prefix(pool.connectable()[1]);
    std::vector<double> result;
    for (const float throughput : throughputs) {
        Connection c{};
        c.eye = {&eye[1], &eye[0], 2, Rgb(1.0f), 0};
        c.order = 2;  // `connections` picks, not those of the first eye vertex
        c.light = {&y[1], &y[0], 2, Rgb(1.0f), light};
        c.beta = Rgb(throughput);
        c.geometry = kLittle;
        result.push_back(density.effectiveSamples(c));
    }
    return result;
}

TEST(Beliefs, neverExceedTheLightSubpaths) {
    const std::vector<float> throughputs = {1e-6f, 1e-2f, 1.0f, 1e2f, 1e6f, 1e12f};
    const std::pair<MethodRow, std::vector<std::string>> cases[] = {
        {findMethod("risbpt"), {"eye_share=0"}},
        {findMethod("tsrbpt"), {"eye_share=0"}},
        {findMethod("tsrbpt"), {"eye_share=0", "points=weighted", "cache_points=3"}},
        {findMethod("icbpt"), {"eye_share=0"}},
        {findMethod("skelbpt"), {}},
        {findMethod("spcbpt"), {}},
    };
    for (const auto& [row, settings] : cases) {
        SCOPED_TRACE(row.name);
        const std::vector<double> n = believedSamples(row, settings, throughputs, kNone);
        for (std::size_t i = 0; i < n.size(); ++i) {
            EXPECT_GT(n[i], 0.0) << throughputs[i];
            EXPECT_LE(n[i], kManySubpaths * (1.0 + 1e-9)) << throughputs[i];
            EXPECT_GE(n[i], n[i > 0 ? i - 1 : 0]) << "brighter is picked more often";
        }
    }
}

/// Subspaces keep the vertices of W whole iterations, so the bound is M W. The brightest vertices
/// fall short of it only by the factor N Gamma / (1 + (N - 1) Gamma).
TEST(Beliefs, neverExceedTheLightSubpathsThatAreKept) {
    const MethodRow row = mappedSubspaceRow();
    // W = M_0 / (M v), at most 32, with M_0 = 400 and v = 0.1, 0.5, 0 and 0.01 vertices per
    // subpath.
    const double windows[] = {32, 10, 32, 32};
    for (Label i = 0; i < 4; ++i) {
        SCOPED_TRACE(i);
        const std::vector<double> n =
            believedSamples(row, {"reuse=400", "weights=ris"}, {1e-6f, 1.0f, 1e6f, 1e30f}, i);
        const double bound = kManySubpaths * windows[i];
        for (const double samples : n) EXPECT_LE(samples, bound * (1.0 + 1e-9));
        EXPECT_GT(n.back(), 0.8 * bound);
    }
}

/// Light is squared where one of the strategies has little variance, and never in the papers' forms.
TEST(Beliefs, squareDirectLightWhereItIsPickedBySight) {
    const std::tuple<const char*, std::vector<std::string>, SquaredLights> cases[] = {
        {"pt", {}, SquaredLights::All},
        {"bpt", {}, SquaredLights::All},
        {"vcm", {}, SquaredLights::All},
        {"pt", {"lamps=power"}, SquaredLights::None},
        {"bpt", {"lamps=power"}, SquaredLights::None},
        {"spcbpt", {}, SquaredLights::Hittable},
        {"sharebpt", {}, SquaredLights::Hittable},
        {"spcbpt", {"weights=paper"}, SquaredLights::None},
    };
    for (const auto& [name, settings, expected] : cases) {
        const MethodRow& row = findMethod(name);
        const auto method = row.create(resolve(row, settings));
        EXPECT_EQ(method->freeze(0).squaredLights(), expected) << name << ", " << settings.size();
    }
    const std::vector<std::string> papers = {"preset=paper"};
    for (const char* name : {"pcbpt", "risbpt", "icbpt", "tsrbpt", "spcbpt"}) {
        const MethodRow& row = findMethod(name);
        const auto method = row.create(resolve(row, papers));
        EXPECT_EQ(method->freeze(0).squaredLights(), SquaredLights::None) << name;
    }
}

}  // namespace
}  // namespace lacuna::test
