// Walks that go on together (Walker::finish), against each of them traced alone.
#include "libcore/bidir/walk.h"

#include <gtest/gtest.h>

#include "tests/bidir/room.h"

namespace lacuna::test {
namespace {

void expectSame(const std::vector<PathVertex>& a, const std::vector<PathVertex>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].position, b[i].position);
        EXPECT_EQ(a[i].throughput, b[i].throughput);
        EXPECT_EQ(a[i].pdfA, b[i].pdfA);
        EXPECT_EQ(a[i].pdfReverseA, b[i].pdfReverseA);
        EXPECT_EQ(a[i].scatter, b[i].scatter);
        EXPECT_EQ(a[i].index, b[i].index);
        EXPECT_EQ(a[i].kind, b[i].kind);
    }
}

TEST(Walker, LampsWithoutABackAreKnown) {
    for (const bool twoSided : {false, true}) {
        SceneBuilder b;
        b.add(quad({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add(emitter(Rgb(1.0f), twoSided))));
        b.add(pointLight({0, 3, 0}, Rgb(1.0f)));
        b.d.cameras.push_back(lookAt({0, 0, 4}, {0, 0, 0}, 60));
        const auto scene = b.build();
        const Camera camera = scene->makeCamera("", {8, 8}, {});
        const Walker walker(*scene, camera, {4, 2});
        int area = 0, point = 0;
        for (std::uint64_t i = 0; i < 64; ++i) {
            Rng rng(1, 0, StreamKind::User, i);
            PathVertex y0;
            ASSERT_TRUE(walker.sampleLight(rng, y0));
            const bool onSurface = scene->lights().kind(y0.light) == LightKind::Area;
            ++(onSurface ? area : point);
            EXPECT_EQ(y0.twoSided, onSurface && twoSided);
        }
        EXPECT_GT(area, 0);
        EXPECT_GT(point, 0);
    }
}

TEST(Walker, TogetherAsAlone) {
    constexpr std::size_t kWalks = 21;  // more than go together, and no multiple of that
    for (const int texels : {4, 300}) {
        const auto scene = room(texels);
        ASSERT_EQ(scene->hasFarTextures(), texels == 300);
        const Camera camera = scene->makeCamera("", {64, 48}, {});
        const Walker walker(*scene, camera, {10, 2});
        for (const Side side : {Side::Eye, Side::Light}) {
            const auto raster = [](std::size_t i) { return Vec2{3.1f * float(i), 20.5f}; };
            std::vector<Rng> rngs;
            for (std::size_t i = 0; i < kWalks; ++i) {
                rngs.emplace_back(1, 0, StreamKind::User, i);
            }
            std::vector<Rng> rngsAlone = rngs;
            std::vector<std::vector<PathVertex>> paths(kWalks);
            std::vector<Walk> walks;
            for (std::size_t i = 0; i < kWalks; ++i) {
                if (side == Side::Eye) {
                    walks.push_back(walker.startEye(raster(i), rngs[i], paths[i]));
                } else if (const auto walk = walker.startLight(rngs[i], paths[i])) {
                    walks.push_back(*walk);
                }
            }
            RayTally together, alone;
            walker.finish(walks, together);

            std::size_t longest = 0;
            for (std::size_t i = 0; i < kWalks; ++i) {
                std::vector<PathVertex> path;
                if (side == Side::Eye) {
                    walker.traceEye(raster(i), rngsAlone[i], alone, path);
                } else {
                    walker.traceLight(rngsAlone[i], alone, path);
                }
                expectSame(paths[i], path);
                EXPECT_EQ(rngs[i].bits(), rngsAlone[i].bits());  // the next numbers agree, too
                longest = std::max(longest, path.size());
            }
            EXPECT_GT(longest, 4u);
            EXPECT_EQ(together.counts, alone.counts);
        }
    }
}

}  // namespace
}  // namespace lacuna::test
