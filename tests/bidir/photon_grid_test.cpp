// The grid of photons, against all of them asked one by one.
#include "libcore/bidir/photon_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcore/base/rng.h"
#include "libcore/bidir/merging.h"

namespace lacuna::test {
namespace {

/// Vertices in clumps, some in one place, on both sides of the origin and far out.
std::vector<PathVertex> clumps(int count, float size) {
    Rng rng(7, 0, StreamKind::User, 0);
    std::vector<PathVertex> vertices(static_cast<std::size_t>(count));
    Vec3 middle{};
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const auto within = [&](float extent) { return extent * (2.0f * rng.uniform() - 1.0f); };
        if (i % 50 == 0) middle = {within(size), within(size), within(size)};
        vertices[i].position = i % 7 == 3 ? middle
                                          : middle + Vec3{within(0.1f * size), within(0.1f * size),
                                                          within(0.01f * size)};
    }
    return vertices;
}

/// All vertices but every third: the grid must leave those out.
std::vector<std::uint32_t> photonsOf(const std::vector<PathVertex>& vertices) {
    std::vector<std::uint32_t> photons;
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
        if (i % 3 != 0) photons.push_back(i);
    }
    return photons;
}

void expectAll(float size, double radius) {
    const std::vector<PathVertex> vertices = clumps(3000, size);
    const std::vector<std::uint32_t> photons = photonsOf(vertices);
    const PhotonGrid grid(vertices, photons, radius);
    std::vector<std::uint32_t> found, expected;
    std::size_t total = 0;
    for (std::size_t n = 0; n < vertices.size(); n += 11) {
        // At photons, beside them, and where there is nothing.
        const Vec3 place = vertices[n].position * (n % 3 == 0 ? 1.0f : n % 3 == 1 ? 1.001f : 3.0f);
        found.clear();
        grid.find(place, found);
        expected.clear();
        for (const std::uint32_t i : photons) {
            const double d2 = lengthSquared(Vec3d(vertices[i].position) - Vec3d(place));
            if (d2 < radius * radius) expected.push_back(i);
        }
        std::ranges::sort(found);
        ASSERT_EQ(found, expected) << size << " " << radius << " " << n;
        total += found.size();
    }
    if (radius > 0.001 * double(size)) {
        EXPECT_GT(total, 100u);
    }
}

TEST(PhotonGrid, findsWhatBruteForceFinds) {
    for (const float size : {1.0f, 1e-20f, 1e15f}) {
        for (const double share : {0.0, 1e-30, 1e-4, 0.01, 0.07, 0.5, 20.0}) {
            expectAll(size, share * double(size));
        }
    }
}

TEST(PhotonGrid, withoutPhotonsThereIsNothing) {
    std::vector<std::uint32_t> found;
    PhotonGrid().find({1, 2, 3}, found);
    PhotonGrid({}, {}, 1.0).find({1, 2, 3}, found);
    EXPECT_TRUE(found.empty());
    EXPECT_TRUE(PhotonGrid().empty());
    EXPECT_EQ(PhotonGrid().bytes(), 0u);
}

TEST(PhotonGrid, answersInOneOrderWhateverTheQuestion) {
    std::vector<PathVertex> vertices(100);
    for (PathVertex& v : vertices) v.position = {0.25f, 0.25f, 0.25f};
    std::vector<std::uint32_t> photons(vertices.size()), found;
    for (std::uint32_t i = 0; i < photons.size(); ++i) photons[i] = i;
    PhotonGrid(vertices, photons, 1.0).find({0.2f, 0.3f, 0.3f}, found);
    EXPECT_EQ(found, photons);
}

/// The merging area falls like i^(alpha - 1), with alpha = 3/4 and i over the iterations of all blocks.
TEST(Merging, radiiShrinkByTheIterationsOfAllBlocks) {
    EXPECT_EQ(mergeRadius(0.5, 0), 0.5);
    EXPECT_NEAR(mergeRadius(0.5, 255), 0.25, 1e-12);  // 256^(-1/8)
    double areas = 0;
    constexpr int kIterations = 100'000;
    for (int i = 0; i < kIterations; ++i) areas += mergeArea(mergeRadius(1.0, std::uint32_t(i)));
    // The sum of i^(-1/4) is 4/3 n^(3/4).
    EXPECT_NEAR(areas / std::pow(kIterations, 0.75), 4.0 / 3.0 * std::numbers::pi, 0.01);
}

PathVertex surface(const Vec3& ng, const Vec3& toPrevious) {
    PathVertex v;
    v.ng = ng;
    v.toPrevious = toPrevious;
    return v;
}

TEST(Merging, takesPhotonsOfTheSameSideOfAboutTheSamePlane) {
    const Vec3 up{0, 0, 1}, from = normalize(Vec3{1, 0, 1});
    const PathVertex eye = surface(up, up);
    EXPECT_TRUE(onSameSurface(surface(up, from), eye));
    EXPECT_TRUE(onSameSurface(surface(up, -from), eye));  // transmitted: f decides
    EXPECT_TRUE(onSameSurface(surface(normalize(Vec3{0, 0.5f, 1}), from), eye));
    EXPECT_FALSE(onSameSurface(surface(-up, from), eye));  // a sheet's other face
    EXPECT_FALSE(onSameSurface(surface(normalize(Vec3{0, 2, 1}), from), eye));
    // The photon came along one surface, and would come from behind the other.
    EXPECT_FALSE(onSameSurface(surface(up, normalize(Vec3{1, 0, 0.1f})),
                               surface(normalize(Vec3{-0.5f, 0, 1}), up)));
}

}  // namespace
}  // namespace lacuna::test
