// Acceptance 1 and 2: weights on real paths. They sum to one over the strategies that can make the
// path, they equal the full products of verify.h, and they do not depend on this iteration's pool.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "libcore/bidir/verify.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

constexpr int kPaths = 10000;

Shot weightShot() {
    Shot shot;
    shot.maxDepth = 7;
    shot.rouletteDepth = 2;
    shot.lightPaths = 512;
    shot.radius = 0.2;  // no mean is looked at, and there must be merges
    return shot;
}

/// Whether strategy t could have drawn every vertex: all densities of its two walks are positive.
bool drawable(const FullPath& path, const TechniqueCounts& techniques, int t) {
    const int s = path.edges + 1 - t;
    for (int i = 0; i <= path.edges; ++i) {
        const double pdf = i < s
                               ? path.lightPdfA[i] * path.lightRoulette(i, techniques.rouletteDepth)
                               : path.eyePdfA[i] * path.eyeRoulette(i, techniques.rouletteDepth);
        if (i < path.edges && !(pdf > 0.0)) return false;
    }
    return true;
}

/// Likewise for the merge at x_i.
bool mergeable(const FullPath& path, const TechniqueCounts& techniques, int i) {
    const double eye = path.eyePdfA[i] * path.eyeRoulette(i, techniques.rouletteDepth);
    return mergedSamples(path, techniques, i) * eye > 0.0 &&
           drawable(path, techniques, path.edges - i);
}

struct Case {
    std::string row;
    int scene;
    std::uint64_t guide = 0;  ///< Shot::guide and Shot::walkGuide
};
void PrintTo(const Case& c, std::ostream* out) {
    *out << c.row << " in " << weightScenes()[std::size_t(c.scene)].name;
    if (c.guide != 0) *out << " guided";
}
std::vector<Case> allCases() {
    std::vector<Case> cases;
    for (const std::string& row : rowNamesOfWeights()) {
        for (int i = 0; i < int(weightScenes().size()); ++i) {
            cases.push_back({row, i});
            // Guided: all rows in some scenes, and some rows in all scenes.
            if (row == "bpt" || row == "spcbpt" || i % 4 == 3) {
                cases.push_back({row, i, std::uint64_t(i) + 1});
            }
        }
    }
    return cases;
}

class Weights : public testing::TestWithParam<Case> {};

TEST_P(Weights, sumToOneAndEqualFullProducts) {
    const NamedScene named = weightScenes()[std::size_t(GetParam().scene)];
    const auto scene = named.builder.build();
    const MethodRow row = rowNamed(GetParam().row);
    Shot shot = weightShot();
    shot.guide = shot.walkGuide = GetParam().guide;
    int judged = 0, refracted = 0;
    double worstSum = 0, worstProduct = 0, ownDifference = 0;
    std::string worstPath;
    const Walker* walker = nullptr;
    shot.observer = [&](const PathEvent& event) {
        if (judged >= kPaths) return;
        ++judged;
        FullPath& path = event.path;
        double sum = 0;
        for (int t = 1; t <= path.edges + 1; ++t) {
            if (!drawable(path, event.counts, t)) continue;
            if (!(effectiveCount(path, event.counts, t) > 0)) continue;
            const double w = misWeight(path, event.counts, t);
            sum += w;
            if (event.technique == Technique(t)) {
                ownDifference = std::max(ownDifference, std::fabs(w - event.weight));
            }
        }
        for (int i = 1; i < path.edges; ++i) {
            if (!mergeable(path, event.counts, i)) continue;
            const Technique merge(path.edges + 1 - i, Technique::By::Merge);
            const double w = misWeight(path, event.counts, merge);
            sum += w;
            if (event.technique == merge) {
                ownDifference = std::max(ownDifference, std::fabs(w - event.weight));
            }
        }
        if (refractedSamples(path, event.counts) > 0) {
            const Technique refraction(event.technique.t, Technique::By::Refraction);
            const double w = misWeight(path, event.counts, refraction);
            sum += w;
            if (event.technique == refraction) {
                ++refracted;
                ownDifference = std::max(ownDifference, std::fabs(w - event.weight));
            }
        }
        worstSum = std::max(worstSum, std::fabs(sum - 1));
        const double again = misWeightByProducts(*walker, path, event.counts, event.technique);
        double difference = std::fabs(again - event.weight);
        // Throughputs are kept in floats: one rounding per edge.
        if (row.techniques.connects && !event.counts.constants) {
            difference -= path.edges * 0x1p-23;
        }
        if (!(difference <= worstProduct)) {
            worstProduct = difference;
            float shortest = 1e30f;
            for (int i = 0; i < path.edges; ++i) {
                if (path.vertex[i]->infinite()) continue;
                shortest = std::min(
                    shortest, length(path.vertex[i]->position - path.vertex[i + 1]->position));
            }
            worstPath =
                "shortest edge " + std::to_string(shortest) + ", " + std::to_string(path.edges) +
                " edges, t = " + std::to_string(event.technique.t) +
                (event.technique.merges() ? " merged" : "") + ", weight " +
                std::to_string(event.weight) + ", sample " + std::to_string(event.sample.number) +
                " of iteration " + std::to_string(event.sample.iteration);
        }
    };
    Render render(*scene, row, shot);
    walker = &render.integrator().walker();
    render.warmUp();
    for (std::uint32_t i = 0; judged < kPaths && i < 2000; ++i) render.iterate(i);

    EXPECT_EQ(judged, kPaths);
    if (named.name == behindGlass().name && row.techniques.refract()) {
        EXPECT_GT(refracted, 50);
    }
    EXPECT_EQ(ownDifference, 0.0);
    EXPECT_LE(worstSum, 1e-9);
    EXPECT_LE(worstProduct, 1e-6) << worstPath;
    EXPECT_EQ(render.statistics().invalidSamples, 0u);
    stabilityCase("weights-sum", worstProduct, "between a weight and its full products");
}

INSTANTIATE_TEST_SUITE_P(All, Weights, testing::ValuesIn(allCases()), ByParameter());

/// A method whose weights stay as they were after the warm-up, while its pools go on changing.
class Frozen final : public Method {
  public:
    Frozen(Method& method) : method_(method) {}
    int warmupIterations() const override { return method_.warmupIterations(); }
    PoolRequest pool() const override { return method_.pool(); }
    Merging merging() const override { return method_.merging(); }
    const ConnectionDensity& freeze(std::uint32_t iteration) override {
        if (!warm_) return method_.freeze(iteration);
        if (!density_) density_ = &method_.freeze(iteration);
        return *density_;
    }
    void prepare(const LightPool& pool, IterationContext& context) override {
        method_.prepare(pool, context);
    }
    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        method_.select(context, rng, sink);
    }
    void observe(const LightPool& pool, IterationContext& context) override {
        if (!warm_) method_.observe(pool, context);
    }
    void endWarmUp() { warm_ = true; }

  private:
    Method& method_;
    const ConnectionDensity* density_ = nullptr;
    bool warm_ = false;
};

/// A path that outlives its walks.
struct KeptPath {
    std::vector<PathVertex> vertices;
    FullPath path;
    Technique technique;
    double weight;
};

/// Copies some of the paths that it is shown.
struct PathKeeper {
    std::vector<std::unique_ptr<KeptPath>> kept;

    void keep(const PathEvent& event) {
        if (kept.size() >= 2000 || event.sample.number % 5 != 0) return;
        auto k =
            std::make_unique<KeptPath>(KeptPath{{}, event.path, event.technique, event.weight});
        for (int i = 0; i <= event.path.edges; ++i) k->vertices.push_back(*event.path.vertex[i]);
        if (event.path.photon) k->vertices.push_back(*event.path.photon);
        if (event.path.photon) k->path.photon = &k->vertices.back();
        for (int i = 0; i <= event.path.edges; ++i) {
            k->path.vertex[i] = &k->vertices[std::size_t(i)];
        }
        kept.push_back(std::move(k));
    }
};

class PathOnly : public testing::TestWithParam<std::string> {};

TEST_P(PathOnly, aPathsWeightIsTheSameUnderAnotherPool) {
    const auto scene = glossyBox().builder.build();
    const MethodRow row = rowNamed(GetParam());
    const auto method = row.create(resolve(row, smallSettings(row, 64)));
    Frozen frozen(*method);
    PathKeeper keeper;
    Shot shot = weightShot();
    shot.observer = [&](const PathEvent& event) { keeper.keep(event); };
    Render first(*scene, row, shot, frozen);
    first.warmUp();
    frozen.endWarmUp();
    first.iterate(0);

    // The first iteration of another seed: another pool, other eye paths.
    shot.seed = 77;
    double worst = 0;
    std::size_t judged = 0;
    const auto judge = [&](const TechniqueCounts& techniques) {
        for (const auto& k : keeper.kept) {
            worst = std::max(worst,
                             std::fabs(misWeight(k->path, techniques, k->technique) - k->weight));
            ++judged;
        }
    };
    ASSERT_GT(keeper.kept.size(), 20u);
    bool done = false;
    std::optional<TechniqueCounts> last;  // a copy, since they end with the iteration
    shot.observer = [&](const PathEvent& event) {
        last = event.counts;
        if (event.technique.t == 1 || done)
            return;  // the pool is complete once the eye's pass has begun
        done = true;
        judge(event.counts);
    };
    Render second(*scene, row, shot, frozen);
    second.iterate(0);
    if (!done) judge(last.value());  // rows without an eye pass
    EXPECT_GE(judged, keeper.kept.size());
    EXPECT_EQ(worst, 0.0);
    stabilityCase("other-pool", worst, "between a path's weights");
}

/// The weights of a method that does not learn are those of the first iteration for ever. A density
/// that used the current pool's number of vertices would change in each iteration.
TEST_P(PathOnly, onlyMethodsThatLearnChangeTheirMinds) {
    const auto scene = glossyBox().builder.build();
    const MethodRow row = rowNamed(GetParam());
    const auto method = row.create(resolve(row, smallSettings(row, 64)));
    if (method->learns()) GTEST_SKIP() << "learns from earlier iterations";
    PathKeeper keeper;
    double worst = 0;
    std::size_t judged = 0;
    bool keeping = true;
    double mergeSamples = 0;
    Shot shot = weightShot();
    shot.observer = [&](const PathEvent& event) {
        if (keeping) {
            mergeSamples = event.counts.mergeSamples;
            return keeper.keep(event);
        }
        if (++judged % 500 != 1) return;  // all events of an iteration have the same counts
        TechniqueCounts counts = event.counts;
        counts.mergeSamples = mergeSamples;  // radii shrink
        for (const auto& k : keeper.kept) {
            const double now = misWeight(k->path, counts, k->technique);
            worst = std::max(worst, std::fabs(now - k->weight));
        }
    };
    Render render(*scene, row, shot, *method);
    render.warmUp();
    render.iterate(0);
    keeping = false;
    for (const std::uint32_t iteration : {1u, 2u, 3u}) render.iterate(iteration);
    ASSERT_GT(keeper.kept.size(), 20u);
    ASSERT_GT(judged, 0u);
    EXPECT_EQ(worst, 0.0);
}

INSTANTIATE_TEST_SUITE_P(All, PathOnly, testing::ValuesIn(rowNamesOfWeights()), ByParameter());

}  // namespace
}  // namespace lacuna::test
