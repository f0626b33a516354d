// Glass bodies with flat faces, and the ways out of them.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/specular/chain_solver.h"
#include "libcore/specular/glass_bodies.h"
#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

/// A lamp, in the coordinates of a scene around the origin.
ChainTarget lampAtPlace(Vec3 place) {
    return {place, false};
}

/// An upright closed prism of radius 1 between y = -1 and 1.
Mesh prism(int sides, std::uint32_t material) {
    Mesh m;
    m.material = material;
    for (const float y : {-1.0f, 1.0f}) {
        for (int i = 0; i < sides; ++i) {
            const double phi = 2 * std::numbers::pi * i / sides;
            m.positions.push_back({float(std::cos(phi)), y, float(std::sin(phi))});
        }
    }
    const auto at = [&](int i, bool top) { return std::uint32_t(i % sides + (top ? sides : 0)); };
    for (int i = 0; i < sides; ++i) {
        m.triangles.push_back({at(i, false), at(i, true), at(i + 1, true)});
        m.triangles.push_back({at(i, false), at(i + 1, true), at(i + 1, false)});
        if (i == 0) continue;
        m.triangles.push_back({at(0, true), at(i + 1, true), at(i, true)});
        m.triangles.push_back({at(0, false), at(i, false), at(i + 1, false)});
    }
    std::erase_if(m.triangles,
                  [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[0] == t[2]; });
    return m;
}

/// The way, refracted by the plane, leads to the target.
TEST(Snell, leadsToTheTarget) {
    const Interface plane{normalize(Vec3d{0.2, 1, -0.3}), 0.7, 1.33};
    const Vec3d from{0.1, -0.4, 0.2};
    const auto refracted = [&](const Vec3d& d) {
        const double cosine = dot(d, plane.normal);
        const Vec3d sine = (d - plane.normal * cosine) * plane.index;
        return sine + plane.normal * std::sqrt(1 - lengthSquared(sine));
    };
    for (const Vec3 place :
         {Vec3{0.3f, 3, 0.1f}, Vec3{4, 2, -7}, Vec3{-900, 380, 5}, Vec3{0.5f, 0.8f, 0.4f}}) {
        const auto way = refractedWay(from, plane, lampAtPlace(place));
        ASSERT_TRUE(way);
        const Vec3d at =
            from + *way * ((plane.offset - dot(from, plane.normal)) / dot(*way, plane.normal));
        EXPECT_LT(length(refracted(*way) - normalize(Vec3d(place) - at)), 1e-6);
    }
    const ChainTarget sky{normalize(Vec3{3, 1, 0.5f}),
                          true};  // low: no straight ray leaves towards it
    const auto way = refractedWay(from, plane, sky);
    ASSERT_TRUE(way);
    EXPECT_LT(length(refracted(*way) - Vec3d(sky.position)), 1e-6);
    EXPECT_FALSE(refractedWay(from, plane, lampAtPlace({0.1f, -3, 0})));
    EXPECT_FALSE(refractedWay({0, 2, 0}, plane, lampAtPlace({0, 5, 0})));
    EXPECT_FALSE(refractedWay(from, plane, {Vec3{0, -1, 0}, true}));
}

/// A rotated and mirrored block around the origin shows the lamp through each of the three faces towards it.
TEST(GlassBodies, showALampThroughEachFaceTowardsIt) {
    SceneBuilder b;
    const Affine turn = rotation({1, 2, 3}, 30);
    b.add(box({-1, -1, -1}, {1, 1, 1}, b.add(glass(1.5f))), turn * scaling({-1, 1, 1}));
    b.add(box({-20, -20, -20}, {20, 20, 20}));
    const auto scene = b.build();
    const GlassBodies bodies(*scene);
    const ChainSolver solver(*scene);
    const Vec3 inside{0.1f, -0.2f, 0.1f};
    const ChainTarget target = lampAtPlace(Vec3(turn.point({4, 4.5, 5})));
    const GlassBodies::WaysOut ways = bodies.waysOut(inside, target);
    ASSERT_EQ(ways.size(), 3u);
    RayTally tally;
    for (std::size_t i = 0; i < ways.size(); ++i) {
        EXPECT_EQ(ways.through(ways[i].normal), &ways[i]);
        EXPECT_EQ(ways.through(-ways[i].normal), &ways[i]);
        const auto found =
            solver.throughGlass({{inside, {}, {}}, target, Chain::kMost}, ways[i].direction, tally);
        ASSERT_TRUE(found);
        EXPECT_EQ(found->chain.size(), 1u);
        EXPECT_GT(std::fabs(dot(found->chain[0].point.ng, ways[i].normal)), 0.9999f);
        // Only this face bends the chain, so the first guess is exact.
        EXPECT_LT(length(found->chain.firstDirection() - ways[i].direction), 1e-5);
    }
    EXPECT_EQ(bodies.waysOut({0, 3, 0}, target).size(), 0u);                  // from outside
    EXPECT_EQ(bodies.waysOut(inside, lampAtPlace({0, 0.1f, 0})).size(), 0u);  // to a lamp within
}

/// Of nested bodies the inner one counts. Open, round and thin bodies do not count.
TEST(GlassBodies, areConvexAndClosed) {
    const auto waysIn = [](void (*add)(SceneBuilder&, std::uint32_t)) {
        SceneBuilder b;
        add(b, b.add(glass(1.5f)));
        b.add(box({-20, -20, -20}, {20, 20, 20}));
        const auto scene = b.build();
        return GlassBodies(*scene).waysOut({}, lampAtPlace({0, 3, 0})).size();
    };
    EXPECT_EQ(waysIn([](SceneBuilder& b, std::uint32_t m) {
                  b.add(box({-1, -1, -1}, {1, 1, 1}, m));
              }),
              1u);
    EXPECT_EQ(waysIn([](SceneBuilder& b, std::uint32_t m) {
                  b.add(quad({-1, 1, 1}, {2, 0, 0}, {0, 0, -2}, m));
              }),
              0u);
    EXPECT_EQ(waysIn([](SceneBuilder& b, std::uint32_t m) { b.add(prism(8, m)); }), 1u);
    EXPECT_EQ(waysIn([](SceneBuilder& b, std::uint32_t m) { b.add(prism(30, m)); }), 0u);
    EXPECT_EQ(waysIn([](SceneBuilder& b, std::uint32_t) {
                  b.add(box({-1, -1, -1}, {1, 1, 1}, b.add(pane({1, 1, 1}))));
              }),
              0u);
    // The lamp lies within the outer one.
    EXPECT_EQ(waysIn([](SceneBuilder& b, std::uint32_t m) {
                  b.add(box({-5, -5, -5}, {5, 5, 5}, m));
                  b.add(box({-1, -1, -1}, {1, 1, 1}, m));
              }),
              1u);
}

/// From inside a round body, guesses lead to the way out, even if the straight way is blocked.
TEST(GlassBodies, guessWaysOutOfWhatIsRound) {
    SceneBuilder b;
    b.add(prism(30, b.add(glass(1.5f))), scaling({2, 2, 2}));
    b.add(quad({0.3f, 0.2f, -0.5f}, {0, 0.8f, 0}, {0, 0, 1}));  // blocks the straight way
    b.add(box({-20, -20, -20}, {20, 20, 20}));
    const auto scene = b.build();
    const GlassBodies bodies(*scene);
    const ChainSolver solver(*scene);
    const ChainTarget target = lampAtPlace({9, 10, 0});
    EXPECT_EQ(bodies.waysOut({}, target).size(), 0u);
    EXPECT_EQ(bodies.roughWaysOut({0, 5, 0}, target).size(), 0u);  // from outside
    const GlassBodies::WaysOut guesses = bodies.roughWaysOut({}, target);
    ASSERT_EQ(guesses.size(),
              2u);  // the top, and the middle one of the sides towards x
    const ChainQuery query{{}, target, Chain::kMost};
    RayTally tally;
    EXPECT_FALSE(solver.throughGlass(query, normalize(Vec3d(target.position)), tally));
    int found = 0;
    for (std::size_t i = 0; i < guesses.size(); ++i) {
        const auto chain = solver.throughGlass(query, guesses[i].direction, tally);
        found += chain && chain->chain.size() == 1 ? 1 : 0;
    }
    EXPECT_GT(found, 0);
}

}  // namespace
}  // namespace lacuna::test
