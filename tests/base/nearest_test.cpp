// The k-d tree against brute force.
#include "libcore/base/nearest.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libcore/base/rng.h"

namespace lacuna::test {
namespace {

double distance2(Vec3 a, Vec3 b) {
    return lengthSquared(Vec3d(a) - Vec3d(b));
}

TEST(NearestPoints, areThoseOfBruteForce) {
    Rng rng(1, 0, StreamKind::User, 0);
    const auto draw = [&](float scale) {
        const float x = rng.uniform(), y = rng.uniform(), z = rng.uniform();
        return Vec3{x * scale, y * scale, z * scale};
    };
    for (const std::size_t n : {1u, 2u, 7u, 300u}) {
        std::vector<Vec3> points, sides;
        const auto side = [&] { return rng.below(4) == 0 ? Vec3{} : normalize(draw(1.0f)); };
        for (std::size_t i = 0; i < n; ++i) {
            // Every fifth is a copy of an earlier one.
            points.push_back(i % 5 == 4 ? points[i / 2] : draw(1.0f));
            sides.push_back(side());
        }
        const float length = 0.7f * rng.uniform();
        const auto apart2 = [&](Vec3 p, Vec3 s, std::size_t i) {
            return distance2(p, points[i]) + distance2(s * length, sides[i] * length);
        };
        const NearestPoints tree(points, sides, length);
        ASSERT_EQ(tree.size(), n);
        for (int query = 0; query < 200; ++query) {
            const Vec3 p = query % 4 == 0 ? points[rng.below(std::uint32_t(n))] : draw(1.5f);
            const Vec3 s = side();
            std::vector<std::uint32_t> found(1 + rng.below(20));
            const std::size_t k = tree.find(p, s, found);
            ASSERT_EQ(k, std::min(n, found.size()));
            std::vector<double> all;
            for (std::size_t i = 0; i < n; ++i) all.push_back(apart2(p, s, i));
            std::sort(all.begin(), all.end());
            std::vector<bool> seen(n);
            for (std::size_t i = 0; i < k; ++i) {
                // The order of points that are equally far is open; how far they are is not.
                EXPECT_NEAR(apart2(p, s, found[i]), all[i], 1e-6);
                EXPECT_FALSE(seen[found[i]]);
                seen[found[i]] = true;
            }
        }
    }
}

TEST(NearestPoints, ofNoneAreNone) {
    std::uint32_t found = 0;
    EXPECT_EQ(NearestPoints().find({}, {}, {&found, 1}), 0u);
    EXPECT_EQ(NearestPoints({}, {}, 1.0f).find({}, {}, {&found, 1}), 0u);
}

// A wall has two faces in nearly the same place; what lies on one is not near the other.
TEST(NearestPoints, areOnTheSameSideOfAThinWall) {
    const Vec3 up{0, 0, 1}, down{0, 0, -1};
    const NearestPoints tree({{0, 0, 0.01f}, {0.9f, 0, -0.01f}}, {up, down}, 1.0f);
    std::uint32_t found = 7;
    tree.find({0, 0, -0.01f}, down, {&found, 1});
    EXPECT_EQ(found, 1u);
    tree.find({0.9f, 0, 0.01f}, up, {&found, 1});
    EXPECT_EQ(found, 0u);
}

}  // namespace
}  // namespace lacuna::test
