// The loss that Gamma minimises: its derivative, its convexity, and what the optimiser reaches.
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

/// Paths that prefer the diagonal, with heavy-tailed contributions.
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
    const GammaResult r =
        optimiseGamma(train, heldOut, fullGamma(train), {.epochs = 10}, threads(), kNever);
    expectColumns(fullGamma(train).q, train.lightCount, 1e-7);
    expectColumns(r.gamma, train.lightCount, 0.999 * kUniformShare / train.lightCount);
    // A column without any data is uniform.
    const GammaResult alone =
        optimiseGamma(train, {}, fullGamma(train), {.epochs = 10}, threads(), kNever);
    EXPECT_EQ(alone.virtualPaths, 0.0);
    for (std::size_t i = r.gamma.size() - train.lightCount; i < r.gamma.size(); ++i) {
        EXPECT_NEAR(alone.gamma[i], 1.0 / train.lightCount, 1e-12);
    }
}

TEST(Gamma, stepsNeverRaiseTheLossAndTheKeptOneIsNoWorseThanTheStart) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        // With so few paths, a long optimisation overfits.
        const GammaData train = randomData(60, 6, 10 + seed),
                        heldOut = randomData(60, 6, 50 + seed);
        const FullGamma full = fullGamma(train);
        const GammaResult alone = optimiseGamma(train, {}, full, {.epochs = 30}, threads(), kNever);
        for (std::size_t n = 1; n < alone.trainLoss.size(); ++n) {
            EXPECT_LE(alone.trainLoss[n], alone.trainLoss[n - 1] * (1 + 1e-12)) << seed;
        }
        EXPECT_EQ(alone.trainLoss[0], alone.fullTrainLoss) << seed;
        const GammaResult r =
            optimiseGamma(train, heldOut, full, {.epochs = 30}, threads(), kNever);
        EXPECT_LE(r.heldOutLoss[r.kept], r.fullHeldOutLoss) << seed;
        EXPECT_NEAR(gammaLoss(heldOut, r.gamma, threads()), r.heldOutLoss[r.kept], 1e-12) << seed;
    }
}

/// The loss is convex: two starts reach the same value.
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
    const GammaResult a =
        optimiseGamma(data, {}, fullGamma(data), {.epochs = 3000}, threads(), kNever);
    const GammaResult b = optimiseGamma(data, {}, other, {.epochs = 3000}, threads(), kNever);
    EXPECT_LT(a.trainLoss.back(), 0.99 * a.trainLoss.front());
    EXPECT_NEAR(a.trainLoss.back() / b.trainLoss.back(), 1.0, 1e-3);
    EXPECT_EQ(a.kept, a.trainLoss.size() - 1);
}

/// Subspaces on a line. A path's light subspace is a smooth function of its eye subspace, up to
/// noise.
GammaData smoothData(std::size_t paths, std::uint32_t n, std::uint64_t seed) {
    Rng rng(seed, 0, StreamKind::User, 0);
    GammaData data;
    data.lightCount = data.eyeCount = n;
    for (std::size_t p = 0; p < paths; ++p) {
        const std::uint32_t eye = rng.below(n),
                            about = std::uint32_t(n * (0.5 + 0.3 * std::sin(eye * 6.0 / n)));
        const std::uint32_t light = (about + rng.below(n / 10) + rng.below(n / 10)) % n;
        data.entries.push_back({light, eye, 1.0f});
        data.endPath(0.1f / (0.05f + rng.uniform()), 0.0f);
    }
    return data;
}

/// Each subspace itself and its neighbours on a line; if `shuffled`, random subspaces in their
/// place.
SubspaceNeighbours neighboursOnALine(std::uint32_t n, bool shuffled) {
    Rng rng(77, 0, StreamKind::User, 0);
    SubspaceNeighbours near;
    for (std::uint32_t i = 0; i < n; ++i) {
        std::vector<std::uint32_t> of = {i};
        for (std::uint32_t d = 1; of.size() < kMostNeighbours && d < n; ++d) {
            if (shuffled)
                of.push_back(rng.below(n));
            else
                for (const std::uint32_t j : {i - d, i + d})
                    if (j < n) of.push_back(j);
        }
        near.light.push_back(of);
        near.eye.push_back(of);
    }
    return near;
}

TEST(Gamma, columnsBorrowFromTheirNeighbours) {
    const std::uint32_t n = 300;
    const GammaData train = smoothData(6000, n, 6), heldOut = smoothData(6000, n, 7),
                    many = smoothData(2'000'000, n, 8);
    const auto heldOutLoss = [&](const GammaData& data, const FullGamma& full) {
        const GammaResult r = optimiseGamma(data, heldOut, full, {.epochs = 20}, threads(), kNever);
        expectColumns(r.gamma, n, 0.999 * kUniformShare / n);
        return r.heldOutLoss[r.kept];
    };
    const double alone = heldOutLoss(train, fullGamma(train));
    const double best = heldOutLoss(many, fullGamma(many));
    const double borrowed =
        heldOutLoss(train, fullGamma(train, neighboursOnALine(n, false), threads()));
    const double misled =
        heldOutLoss(train, fullGamma(train, neighboursOnALine(n, true), threads()));
    EXPECT_LT(best, borrowed);
    EXPECT_LT(borrowed, 0.5 * alone);
    EXPECT_LT(misled, 1.2 * alone);  // unrelated neighbours cost little
}

/// Three eye subspaces, computed by hand.
TEST(Gamma, aNeighbourhoodIsItsSubspacesTogether) {
    GammaData data;
    data.lightCount = 2;
    data.eyeCount = 3;
    const auto add = [&](std::uint32_t light, std::uint32_t eye, int times) {
        for (int k = 0; k < times; ++k) {
            data.entries.push_back({light, eye, 1.0f});
            data.endPath(2.0f, 0.0f);
        }
    };
    add(0, 0, 3), add(1, 0, 1);  // column 0: 3/4, 1/4 of four paths
    add(0, 1, 1), add(1, 1, 1);  // column 1: 1/2, 1/2 of two
    add(1, 2, 4);                // column 2: 0, 1 of four; alone
    const FullGamma full = fullGamma(data, {{{0}, {1}}, {{0, 1}, {1, 0}, {2}}}, threads());
    ASSERT_EQ(full.around.size(), std::size(kNeighbourhoods));
    for (const GammaColumns& around : full.around) {
        EXPECT_NEAR(around.paths[0], 6.0, 1e-9);
        EXPECT_NEAR(around.paths[2], 4.0, 1e-9);
        EXPECT_NEAR(around.q[0], 4.0 / 6.0, 1e-5);
        EXPECT_NEAR(around.q[2], 4.0 / 6.0, 1e-5);
        EXPECT_NEAR(around.q[4], 0.0, 1e-5);
    }
    // If the two light subspaces are neighbours, all columns have the shares of m^0: 4/10, 6/10.
    const FullGamma one = fullGamma(data, {{{0, 1}, {1, 0}}, {{0}, {1}, {2}}}, threads());
    for (const GammaColumns& around : one.around) {
        for (const std::size_t j : {0, 1, 2}) EXPECT_NEAR(around.q[2 * j], 0.4, 1e-5);
    }
}

TEST(Gamma, degenerateDataIsHandled) {
    // No data.
    GammaData none;
    none.lightCount = 3;
    none.eyeCount = 2;
    const GammaResult empty =
        optimiseGamma(none, none, fullGamma(none), {.epochs = 5}, threads(), kNever);
    for (const double g : empty.gamma) EXPECT_NEAR(g, 1.0 / 3.0, 1e-15);
    // One path and one subspace.
    GammaData one;
    one.entries.push_back({0, 0, 2.0f});
    one.endPath(3.0f, 0.0f);
    const GammaResult single =
        optimiseGamma(one, none, fullGamma(one), {.epochs = 5}, threads(), kNever);
    ASSERT_EQ(single.gamma.size(), 1u);
    EXPECT_NEAR(single.gamma[0], 1.0, 1e-12);
    EXPECT_NEAR(single.trainLoss.back(), 9.0 / 2.0, 1e-6);
}

}  // namespace
}  // namespace lacuna::test
