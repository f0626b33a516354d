// Walks that pixels lend each other: what a borrower gets, and how the pixels that could have gone one way share it.
#include "libcore/bidir/lent_walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/bidir/room.h"

namespace lacuna::test {
namespace {

constexpr int kDepth = 6;

struct Walks {
    explicit Walks(const Scene& s) : scene(s), camera(s.makeCamera("", {64, 48}, {})) {}

    /// Calls f(walk, h, n) for those of 400 walks that can be lent, from their z_h on.
    template <class F>
    void forEachLent(const F& f) {
        for (std::uint64_t n = 0; n < 400; ++n) {
            const std::vector<PathVertex> walk = trace({0.15f * float(n), 20.5f}, n);
            if (const std::size_t h = LentWalk::begin(walk); h > 0) f(walk, h, n);
        }
    }

    std::vector<PathVertex> trace(Vec2 raster, std::uint64_t number) {
        Rng rng(1, 0, StreamKind::User, number);
        std::vector<PathVertex> path;
        walker.traceEye(raster, rng, tally, path);
        return path;
    }

    const Scene& scene;
    Camera camera;
    Walker walker{scene, camera, {kDepth, 1}};
    RayTally tally;
};

void expectAlike(const Rgb& a, const Rgb& b) {
    const double allowed = 1e-4 * double(std::max(mean(a), mean(b)));
    EXPECT_NEAR(a.r, b.r, allowed);
    EXPECT_NEAR(a.g, b.g, allowed);
    EXPECT_NEAR(a.b, b.b, allowed);
}

/// No other pixel sees the vertex after z_h: the walk stays what it was.
TEST(LentWalk, aloneIsTheWalkItself) {
    const auto scene = room(4);
    Walks walks(*scene);
    int lent = 0;
    walks.forEachLent([&](const std::vector<PathVertex>& own, std::size_t h, std::uint64_t) {
        ++lent;
        LentWalk walk(walks.walker, own, h);
        walk.add(own, walks.tally);
        std::vector<PathVertex> taken;
        walk.take(0, walk.lastEnd(), taken);
        ASSERT_EQ(taken.size(), walk.lastEnd());
        for (std::size_t i = 0; i < taken.size(); ++i) {
            const bool last = i + 2 > taken.size();  // its reverse density is still open
            expectAlike(taken[i].throughput, own[i].throughput);
            EXPECT_NEAR(taken[i].pdfA, own[i].pdfA, 1e-4 * double(own[i].pdfA));
            if (last || i + 2 == taken.size()) continue;
            EXPECT_NEAR(taken[i].pdfReverseA, own[i].pdfReverseA,
                        1e-4 * double(own[i].pdfReverseA) + 1e-7);
            expectAlike(taken[i].scatter, own[i].scatter);
        }
    });
    EXPECT_GT(lent, 100);
}

/// If two pixels see the vertex, both get the arriving light over the sum of both densities.
TEST(LentWalk, isASampleOfAllWhoCouldHaveGoneIt) {
    const auto scene = room(4);
    Walks walks(*scene);
    int shared = 0;
    walks.forEachLent([&](const std::vector<PathVertex>& a, std::size_t h, std::uint64_t n) {
        const std::vector<PathVertex> b = walks.trace({0.15f * float(n) + 3.0f, 22.5f}, n + 1000);
        if (!LentWalk::forksAt(b, h)) return;
        LentWalk walk(walks.walker, a, h), alone(walks.walker, a, h);
        walk.add(a, walks.tally);
        walk.add(b, walks.tally);
        alone.add(a, walks.tally);
        std::vector<PathVertex> ofA, ofB, ofAAlone;
        walk.take(0, h + 2, ofA);
        alone.take(0, h + 2, ofAAlone);
        if (!walk.leadsFrom(1)) {
            expectAlike(ofA.back().throughput, ofAAlone.back().throughput);
            return;
        }
        ++shared;
        walk.take(1, h + 2, ofB);
        EXPECT_EQ(ofB[h].position, b[h].position);
        EXPECT_EQ(ofB[h + 1].position, a[h + 1].position);
        const auto density = [&](const std::vector<PathVertex>& path) {
            const PathVertex& z = path[h];
            return double(z.survival) * double(path[h + 1].pdfA);
        };
        const double sum = density(ofA) + density(ofB);
        expectAlike(ofA.back().throughput, ofAAlone.back().throughput * float(density(ofA) / sum));
        const Edge edge = edgeBetween(b[h], a[h + 1]);
        const Rgb arrives = b[h].throughput *
                            walks.walker.scattering(b[h], b[h].toPrevious, edge.direction).f *
                            edge.geometry;
        expectAlike(ofB.back().throughput, arrives * float(1 / sum));
    });
    EXPECT_GT(shared, 50);
}

}  // namespace
}  // namespace lacuna::test
