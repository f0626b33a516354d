// Tests selectors alone. Over picks from a small fixed pool, the mean of sum weight g equals (1/M)
// sum g, for a positive g and for one that is zero on half of the pool.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/parallel.h"
#include "tests/fixtures/finite_space.h"
#include "tests/fixtures/test_rows.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

TEST(Selector, meanOfWeightedPicksIsTheMeanOverThePool) {
    const FiniteSpace space(3);
    const ThreadPool threads(1);
    IterationStatistics statistics;
    double worst = 0.0;
    IterationContext context{space, threads, 20, 0, 1000, statistics};
    // A row may draw in prepare() what it picks from in select(), so the mean is taken over both.
    constexpr int kSubpaths = 5, kPrepares = 1000, kDraws = 400;
    // 4.5 standard errors: 7e-6 false alarms per comparison, two comparisons per row.
    for (const MethodRow& row : allRows()) {
        const auto settings = smallSettings(row, kSubpaths);
        if (settings.empty()) continue;  // no pool
        const auto method = row.create(resolve(row, settings));
        method->freeze(0);
        context.generation = 0;
        LightPool pool;
        pool.reset(kSubpaths);
        std::vector<PathVertex> path;
        for (std::uint64_t i = 0; i < kSubpaths; ++i) {
            Rng rng(21, 0, StreamKind::LightPath, i);
            space.traceLight(rng, path);
            pool.add(path, FiniteSpace::kMaxEdges);
        }
        ASSERT_GE(pool.connectable().size(), 5u);
        ASSERT_LE(pool.connectable().size(), 25u);
        std::vector<PathVertex> eye;
        Rng eyeRng(22, 0, StreamKind::EyePath, 0);
        do {
            space.traceEye(eyeRng, eye);
        } while (eye.size() < 4 || !eye[1].connectable() || !eye[3].connectable());
        // A row may make more picks for some t than for others.
        const Subpath ends[] = {{eye.data(), 2}, {eye.data(), 4}};

        const auto g = [](const PathVertex& v, bool halfZero) {
            const int state = FiniteSpace::stateOf(v);
            // A vertex without throughput need not be picked.
            if ((halfZero && state % 2 == 0) || isBlack(v.throughput)) return 0.0;
            return 0.3 + 0.1 * state + 0.2 * v.index;
        };
        double sum[2] = {0, 0}, squares[2] = {0, 0};  // of the means after one prepare
        ProposalSink sink;
        RayTally tally;
        Rng rng(23, 0, StreamKind::Connection, 0);
        // The first round only fills the pool that some rows retain. It is the same pool in all
        // rounds.
        for (std::uint32_t round = 0; round <= kPrepares; ++round) {
            if (round > 0) method->freeze(round);
            method->prepare(pool, context);
            double value[2] = {0, 0};
            for (int n = 0; n < kDraws && round > 0; ++n) {
                sink.clear();
                const Subpath z = ends[n % 2];
                method->select({z.back(), z, {}, 0, round, space, space, tally}, rng, sink);
                for (const Proposal& p : sink.proposals()) {
                    const PathVertex& y = p.light.back();
                    ASSERT_TRUE(y.connectable()) << row.name;
                    ASSERT_EQ(p.light.size(), std::size_t(y.index) + 1) << row.name;
                    if (p.light.size() == 1) continue;
                    for (const int half : {0, 1}) value[half] += p.weight * g(y, half) / kDraws;
                }
            }
            for (const int half : {0, 1}) {
                sum[half] += value[half];
                squares[half] += value[half] * value[half];
            }
            method->observe(pool, context);
            ++context.generation;
        }
        for (const int half : {0, 1}) {
            double truth = 0.0;
            for (const LightPool::Entry& entry : pool.connectable()) {
                const PathVertex& v = pool.prefix(entry).back();
                if (v.index > 0) truth += g(v, half) / kSubpaths;
            }
            const double m = sum[half] / kPrepares;
            const double error = std::sqrt((squares[half] / kPrepares - m * m) / kPrepares);
            EXPECT_NEAR(m, truth, 4.5 * error + 1e-12) << row.name << " half zero " << half;
            worst = std::max(worst, std::fabs(m - truth) / (4.5 * error + 1e-12));
        }
    }
    stabilityCase("zero-targets", worst, "of the deviation allowed");
}

}  // namespace
}  // namespace lacuna::test
