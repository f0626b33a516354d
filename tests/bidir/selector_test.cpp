// Acceptance 3: selectors alone. Over picks from a small fixed pool, the mean of sum weight g
// equals (1/M) sum g, for a positive g and for one that is zero on half of the pool.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/parallel.h"
#include "tests/bidir/finite_space.h"
#include "tests/bidir/test_rows.h"

namespace lacuna::test {
namespace {

TEST(Selector, meanOfWeightedPicksIsTheMeanOverThePool) {
    const FiniteSpace space(3);
    const ThreadPool threads(1);
    IterationStatistics statistics;
    IterationContext context{space, threads, 20, 1000, statistics};
    constexpr int kSubpaths = 5, kDraws = 400000;
    // 4.5 standard errors: 7e-6 false alarms per comparison, about 10 comparisons.
    for (const MethodRow& row : allRows()) {
        const auto settings = smallSettings(row, kSubpaths);
        if (settings.empty()) continue;  // no pool
        const auto method = row.create(resolve(row, settings));
        method->freeze(0);
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
        // Retaining rows see the same pool as the one they kept.
        method->prepare(pool, context);
        method->observe(pool, context);
        method->prepare(pool, context);

        std::vector<PathVertex> eye;
        Rng eyeRng(22, 0, StreamKind::EyePath, 0);
        do {
            space.traceEye(eyeRng, eye);
        } while (eye.size() < 2 || !eye[1].connectable());
        const Subpath z(eye.data(), 2);

        for (const bool halfZero : {false, true}) {
            const auto g = [&](const PathVertex& v) {
                const int state = FiniteSpace::stateOf(v);
                if (halfZero && state % 2 == 0) return 0.0;
                return 0.3 + 0.1 * state + 0.2 * v.index;
            };
            double truth = 0.0;
            for (std::size_t i = 0; i < pool.connectable().size(); ++i) {
                const PathVertex& v = pool.prefix(pool.connectable()[i]).back();
                if (v.index > 0) truth += g(v) / kSubpaths;
            }
            double sum = 0.0, squares = 0.0;
            ProposalSink sink;
            Rng rng(23, 0, StreamKind::Connection, 0);
            for (int n = 0; n < kDraws; ++n) {
                sink.clear();
                method->select({z.back(), z, {}, 0, 0, space}, rng, sink);
                double value = 0.0;
                for (const Proposal& p : sink.proposals()) {
                    ASSERT_TRUE(p.light.back().connectable()) << row.name;
                    ASSERT_EQ(p.light.size(), std::size_t(p.light.back().index) + 1) << row.name;
                    if (p.light.size() > 1) value += p.weight * g(p.light.back());
                }
                sum += value;
                squares += value * value;
            }
            const double m = sum / kDraws;
            const double error = std::sqrt((squares / kDraws - m * m) / kDraws);
            EXPECT_NEAR(m, truth, 4.5 * error + 1e-12) << row.name << " half zero " << halfZero;
        }
    }
}

}  // namespace
}  // namespace lacuna::test
