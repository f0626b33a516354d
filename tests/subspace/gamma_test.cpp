// The loss that Gamma minimises: its derivative, its convexity, what the optimiser makes of it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/subspace/gamma.h"

namespace lacuna::test {
namespace {

const ThreadPool& threads() {
    static const ThreadPool pool(2);
    return pool;
}
const std::atomic<bool> kNever{false};

/// Paths that prefer subspaces near the diagonal; heavy-tailed contributions.
GammaData randomData(std::size_t paths, std::uint32_t n, std::uint64_t seed) {
    Rng rng(seed, 0, StreamKind::User, 0);
    GammaData data;
    data.lightCount = n + 2;  // the last two are never seen
    data.eyeCount = n + 1;
    for (std::size_t p = 0; p < paths; ++p) {
        const std::uint32_t connections = 1 + rng.below(4);
        for (std::uint32_t e = 0; e < connections; ++e) {
            const std::uint32_t eye = rng.below(n);
            const std::uint32_t light = rng.below(2) ? eye : rng.below(n);
            data.entries.push_back({light, eye, 0.1f + 3.0f * rng.uniform()});
        }
        data.endPath(0.1f / (0.05f + rng.uniform()), 0.05f * rng.uniform());
    }
    return data;
}

TEST(Gamma, derivativeMeetsFiniteDifferences) {
    const GammaData data = randomData(400, 5, 1);
    SubspaceMatrix e = mixedGamma(fullGamma(data).q, data.lightCount), derivative;
    gammaLoss(data, e, threads(), &derivative);
    double largest = 0.0;
    for (const double d : derivative) largest = std::max(largest, std::fabs(d));
    for (std::size_t n = 0; n < e.size(); ++n) {
        const double h = 1e-5, kept = e[n];
        e[n] = kept + h;
        const double above = gammaLoss(data, e, threads());
        e[n] = kept - h;
        const double below = gammaLoss(data, e, threads());
        e[n] = kept;
        EXPECT_NEAR(derivative[n], (above - below) / (2 * h), 1e-7 * largest) << n;
    }
}

void expectColumns(const SubspaceMatrix& m, std::uint32_t rows, double least) {
    for (std::size_t begin = 0; begin < m.size(); begin += rows) {
        double sum = 0.0;
        for (std::size_t i = begin; i < begin + rows; ++i) {
            EXPECT_GE(m[i], least);
            sum += m[i];
        }
        EXPECT_NEAR(sum, 1.0, 1e-12);
    }
}

TEST(Gamma, columnsSumToOneAndHoldTheUniformShare) {
    const GammaData train = randomData(2000, 6, 2), heldOut = randomData(500, 6, 3);
    const GammaResult r = optimiseGamma(train, heldOut, fullGamma(train), 10, threads(), kNever);
    expectColumns(fullGamma(train).q, train.lightCount, 1e-7);
    expectColumns(r.gamma, train.lightCount, 0.999 * kUniformShare / train.lightCount);
    // A column of which nothing is known is uniform.
    const GammaResult alone = optimiseGamma(train, {}, fullGamma(train), 10, threads(), kNever);
    EXPECT_EQ(alone.virtualPaths, 0.0);
    for (std::size_t i = r.gamma.size() - train.lightCount; i < r.gamma.size(); ++i) {
        EXPECT_NEAR(alone.gamma[i], 1.0 / train.lightCount, 1e-12);
    }
}

TEST(Gamma, stepsNeverRaiseTheLossAndTheKeptOneIsNoWorseThanTheStart) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        // Few paths: optimised long enough, they are fitted too closely.
        const GammaData train = randomData(60, 6, 10 + seed),
                        heldOut = randomData(60, 6, 50 + seed);
        const FullGamma full = fullGamma(train);
        const GammaResult alone = optimiseGamma(train, {}, full, 30, threads(), kNever);
        for (std::size_t n = 1; n < alone.trainLoss.size(); ++n) {
            EXPECT_LE(alone.trainLoss[n], alone.trainLoss[n - 1] * (1 + 1e-12)) << seed;
        }
        EXPECT_EQ(alone.trainLoss[0], alone.fullTrainLoss) << seed;
        const GammaResult r = optimiseGamma(train, heldOut, full, 30, threads(), kNever);
        EXPECT_LE(r.heldOutLoss[r.kept], r.fullHeldOutLoss) << seed;
        EXPECT_NEAR(gammaLoss(heldOut, r.gamma, threads()), r.heldOutLoss[r.kept], 1e-12) << seed;
    }
}

/// Convex: from two starts to the same loss.
TEST(Gamma, twoStartsReachOneLoss) {
    const GammaData data = randomData(1000, 6, 4);
    const std::size_t size = std::size_t(data.lightCount) * data.eyeCount;
    FullGamma other = fullGamma(data);
    SubspaceMatrix& odd = other.q;
    Rng rng(5, 0, StreamKind::User, 0);
    for (std::size_t begin = 0; begin < size; begin += data.lightCount) {
        double sum = 0.0;
        for (std::size_t i = begin; i < begin + data.lightCount; ++i) {
            sum += odd[i] = std::pow(rng.uniformDouble(), 8.0) + 1e-6;
        }
        for (std::size_t i = begin; i < begin + data.lightCount; ++i) odd[i] /= sum;
    }
    const GammaResult a = optimiseGamma(data, {}, fullGamma(data), 3000, threads(), kNever);
    const GammaResult b = optimiseGamma(data, {}, other, 3000, threads(), kNever);
    EXPECT_LT(a.trainLoss.back(), 0.99 * a.trainLoss.front());
    EXPECT_NEAR(a.trainLoss.back() / b.trainLoss.back(), 1.0, 1e-3);
    EXPECT_EQ(a.kept, a.trainLoss.size() - 1);
}

TEST(Gamma, degenerateDataIsHandled) {
    // Nothing at all.
    GammaData none;
    none.lightCount = 3;
    none.eyeCount = 2;
    const GammaResult empty = optimiseGamma(none, none, fullGamma(none), 5, threads(), kNever);
    for (const double g : empty.gamma) EXPECT_NEAR(g, 1.0 / 3.0, 1e-15);
    // One path, one subspace.
    GammaData one;
    one.entries.push_back({0, 0, 2.0f});
    one.endPath(3.0f, 0.0f);
    const GammaResult single = optimiseGamma(one, none, fullGamma(one), 5, threads(), kNever);
    ASSERT_EQ(single.gamma.size(), 1u);
    EXPECT_NEAR(single.gamma[0], 1.0, 1e-12);
    EXPECT_NEAR(single.trainLoss.back(), 9.0 / 2.0, 1e-6);
}

}  // namespace
}  // namespace lacuna::test
