// Values of very different sizes: positions, weights, powers, contributions and densities over
// thirty decades and more.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/subspace/centroids.h"
#include "libcore/subspace/decision_tree.h"
#include "libcore/subspace/gamma.h"
#include "libcore/subspace/light_cells.h"
#include "libcore/subspace/subspaces.h"
#include "tests/scene/scene_builder.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

const std::atomic<bool> kNever{false};

/// A number between 1e-d and 1e+d; every decade is equally likely.
float anyDecade(Rng& rng, double d) {
    return float(std::pow(10.0, d * (2 * rng.uniformDouble() - 1)));
}

/// One split tells two labels apart whose attributes differ by a factor of 1e30. Labels by decade
/// are more than halving a range 32 times can separate.
TEST(Ranges, treesOverSixtyDecades) {
    Rng rng(1, 0, StreamKind::User, 0);
    std::vector<SubpathEnd> parted(400), decades(3000);
    std::vector<std::uint32_t> side, decade;
    for (std::size_t i = 0; i < parted.size(); ++i) {
        const bool far = i % 2 == 1;
        for (float& v : parted[i].value) v = (1 + rng.uniform()) * (far ? 1e15f : 1e-15f);
        side.push_back(far ? 1 : 0);
    }
    EXPECT_EQ(treeAccuracy(growTree(parted, side, 2), parted, side), 1.0);

    for (SubpathEnd& e : decades) {
        const double exponent = 60 * rng.uniformDouble() - 30;
        for (float& v : e.value) v = float(std::pow(10.0, exponent) * (rng.below(2) ? 1 : -1));
        decade.push_back(std::uint32_t(exponent + 30));
    }
    const DecisionTree tree = growTree(decades, decade, 60);
    EXPECT_LE(tree.depth(), DecisionTree::kMaxDepth);
    EXPECT_NO_THROW(DecisionTree({tree.nodes().begin(), tree.nodes().end()}, 60));
    // The tree tells apart the decades that 32 halvings of a range reach.
    EXPECT_GT(treeAccuracy(tree, decades, decade), 0.1);

    // The difference of these bounds overflows a float.
    std::vector<SubpathEnd> whole(2);
    whole[0].value[0] = -std::numeric_limits<float>::max();
    whole[1].value[0] = std::numeric_limits<float>::max();
    const std::vector<std::uint32_t> two = {0, 1};
    EXPECT_EQ(treeAccuracy(growTree(whole, two, 2), whole, two), 1.0);
    stabilityCase("tree-range", tree.depth(), "levels, of 32");
}

TEST(Ranges, centroidsOfWeightsOverSixtyDecades) {
    Rng rng(2, 0, StreamKind::User, 0);
    std::vector<SubpathEnd> ends(2000);
    std::vector<float> weights;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        for (float& v : ends[i].value) v = anyDecade(rng, 15);
        weights.push_back(anyDecade(rng, 30));
    }
    const auto drawn = drawCentroids(ends, weights, 50, rng);
    ASSERT_FALSE(drawn.empty());
    EXPECT_LE(drawn.size(), 50u);
    const auto heaviest =
        std::size_t(std::max_element(weights.begin(), weights.end()) - weights.begin());
    bool found = false;
    for (const SubpathEnd& e : drawn) found |= e.value == ends[heaviest].value;
    EXPECT_TRUE(found);
    const float sigma2 = spatialVariance(ends);
    EXPECT_TRUE(std::isfinite(sigma2));
    EXPECT_GT(sigma2, 0.0f);
    const Centroids centroids(drawn, sigma2);
    std::set<std::uint32_t> labels;
    for (const SubpathEnd& e : drawn) labels.insert(centroids.nearest(e));
    EXPECT_LT(*labels.rbegin(), drawn.size());
    stabilityCase("centroid-range", double(drawn.size()), "centroids, of 50 draws");
}

TEST(Ranges, cellsOfLampsOverThirtyDecades) {
    SceneBuilder b;
    b.add(quad({0, 0, 0}, {9, 0, 0}, {0, 0, 9}));
    for (int i = -15; i <= 15; ++i) {
        b.add(quad({float(i), 4, 0}, {0.5f, 0, 0}, {0, 0, 0.5f},
                   b.add(emitter(Rgb(float(std::pow(10.0, i)))))));
    }
    const auto scene = b.build();
    double most = 0;
    for (const std::uint32_t wanted : {1u, 20u, 200u}) {
        const LightCells cells(scene->lights(), wanted);
        EXPECT_GE(cells.count(), 1u);
        EXPECT_LE(cells.count(), wanted + 1);
        for (std::uint32_t i = 0; i < scene->lights().size(); ++i) {
            EXPECT_LT(cells.blocks()[i].first, cells.count());
        }
        most = std::max(most, double(cells.count()) / wanted);
    }
    stabilityCase("lamp-range", most, "of the cells asked for");
}

/// Contributions and densities over thirty decades each, so that terms of the loss span ninety.
TEST(Ranges, gammaOverThirtyDecades) {
    const ThreadPool threads(2);
    double worst = 0;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        Rng rng(3, 0, StreamKind::User, seed);
        GammaData parts[2];
        for (GammaData& data : parts) {
            data.lightCount = 7;
            data.eyeCount = 5;
            for (int p = 0; p < 300; ++p) {
                const std::uint32_t connections = 1 + rng.below(4);
                for (std::uint32_t e = 0; e < connections; ++e) {
                    data.entries.push_back({rng.below(6), rng.below(4), anyDecade(rng, 15)});
                }
                data.endPath(anyDecade(rng, 15), rng.below(3) ? anyDecade(rng, 15) : 0.0f);
            }
        }
        const FullGamma full = fullGamma(parts[0]);
        for (const bool heldOut : {false, true}) {
            const GammaResult r = optimiseGamma(parts[0], heldOut ? parts[1] : GammaData{}, full,
                                                {.epochs = 20}, threads, kNever);
            for (const double loss : r.trainLoss) EXPECT_TRUE(std::isfinite(loss)) << seed;
            for (std::size_t n = 1; n < r.trainLoss.size() && !heldOut; ++n) {
                EXPECT_LE(r.trainLoss[n], r.trainLoss[n - 1] * (1 + 1e-12)) << seed;
            }
            Subspaces result;  // as in a file, with the checks of reading
            result.lightCount = parts[0].lightCount;
            result.eyeCount = parts[0].eyeCount;
            result.gamma.assign(r.gamma.begin(), r.gamma.end());
            EXPECT_NO_THROW(result.check()) << seed;
            for (std::uint32_t j = 0; j < result.eyeCount; ++j) {
                double sum = 0;
                for (std::uint32_t i = 0; i < result.lightCount; ++i) {
                    const double g = r.gamma[std::size_t(j) * result.lightCount + i];
                    EXPECT_GE(g, 0.999 * kUniformShare / result.lightCount) << seed;
                    sum += g;
                }
                worst = std::max(worst, std::fabs(sum - 1));
            }
        }
    }
    EXPECT_LT(worst, 1e-12);
    stabilityCase("gamma-range", worst, "off a column's sum of one, at most");
}

}  // namespace
}  // namespace lacuna::test
