// Blocks of iterations: each with a method of its own, and with random numbers of its own.
#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "libcore/bidir/integrator.h"
#include "tests/bidir/room.h"

namespace lacuna::test {
namespace {

/// What all methods of a render saw.
struct Seen {
    std::vector<std::uint32_t> generations;
    std::vector<Vec3> pools;  ///< second vertex of the first light subpath that has one
};

class Notes final : public Method {
  public:
    explicit Notes(Seen& seen) : seen_(seen) {}
    int warmupIterations() const override { return 2; }
    PoolRequest pool() const override { return {8}; }
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }
    void prepare(const LightPool& pool, IterationContext& context) override {
        seen_.generations.push_back(context.generation);
        for (const PathVertex& v : pool.vertices()) {
            if (v.index != 1) continue;
            seen_.pools.push_back(v.position);
            return;
        }
    }
    void select(const EyeContext&, Rng&, ProposalSink&) const override {}

  private:
    class OneSample final : public ConnectionDensity {
        double effectiveSamples(const Connection&) const override { return 1.0; }
    };
    Seen& seen_;
    OneSample density_;
};

Seen seenBy(const Scene& scene, std::uint64_t blockIterations,
            const std::vector<std::uint64_t>& blocks) {
    const Camera camera = scene.makeCamera("", {4, 4}, {});
    RenderSettings settings;
    settings.crop = {0, 4, 0, 4};
    settings.blockIterations = blockIterations;
    const ThreadPool threads(1);
    Seen seen;
    Notes unused(seen);
    BidirIntegrator integrator(scene, camera, {.connects = true}, unused, settings, threads);
    const std::atomic<bool> never{false};
    IterationStatistics statistics;
    std::vector<Rgb> pixels(16);
    for (const std::uint64_t block : blocks) {
        Notes fresh(seen);
        EXPECT_TRUE(integrator.beginBlock(block, fresh, never, statistics));
        for (std::uint64_t i = 0; i < blockIterations; ++i) {
            const auto number = std::uint32_t(block * blockIterations + i);
            EXPECT_TRUE(integrator.render(number, pixels, never, statistics));
        }
    }
    return seen;
}

TEST(Blocks, drawNumbersOfTheirOwnInWarmUpsToo) {
    const auto scene = room(4);
    for (const std::uint64_t size : {1u, 2u, 5u}) {
        SCOPED_TRACE(size);
        const Seen seen = seenBy(*scene, size, {0, 1, 2, 3});
        ASSERT_EQ(seen.generations.size(), 4 * (2 + size));
        // Blocks use one generation after the other, so that the first block is that of a render
        // without blocks.
        for (std::uint32_t i = 0; i < seen.generations.size(); ++i) {
            EXPECT_EQ(seen.generations[i], i);
        }
        ASSERT_EQ(seen.pools.size(), seen.generations.size());
        std::set<std::tuple<float, float, float>> different;
        for (const Vec3& p : seen.pools) different.insert({p.x, p.y, p.z});
        EXPECT_EQ(different.size(), seen.pools.size());
    }
}

TEST(Blocks, doNotKnowWhichBlocksWereMadeBefore) {
    const auto scene = room(4);
    const Seen inOrder = seenBy(*scene, 3, {0, 1, 2, 3}), alone = seenBy(*scene, 3, {2});
    ASSERT_EQ(alone.pools.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(alone.generations[i], inOrder.generations[10 + i]);
        EXPECT_EQ(alone.pools[i], inOrder.pools[10 + i]);
    }
}

}  // namespace
}  // namespace lacuna::test
