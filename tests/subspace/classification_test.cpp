// Subspaces: nearest centroids, the decision trees that replace them, cells of lights.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "libcore/base/rng.h"
#include "libcore/subspace/centroids.h"
#include "libcore/subspace/decision_tree.h"
#include "libcore/subspace/light_cells.h"
#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

Vec3 randomUnit(Rng& rng) {
    for (;;) {
        const Vec3 v{2 * rng.uniform() - 1, 2 * rng.uniform() - 1, 2 * rng.uniform() - 1};
        if (lengthSquared(v) > 0.01f && lengthSquared(v) < 1.0f) return normalize(v);
    }
}

/// An end on the walls of a box, with the wall's normal, as subpaths have them.
SubpathEnd onBox(Rng& rng) {
    Vec3 p{rng.uniform(), rng.uniform(), rng.uniform()}, n;
    const std::size_t axis = rng.below(3);
    const bool far = rng.below(2) == 1;
    p[axis] = far ? 1.0f : 0.0f;
    n[axis] = far ? -1.0f : 1.0f;
    const Vec3 d = randomUnit(rng);
    return subpathEnd(p * 4.0f, n, p * 4.0f + d, false);
}

std::vector<SubpathEnd> ends(std::size_t count, std::uint64_t seed) {
    Rng rng(seed, 0, StreamKind::User, 0);
    std::vector<SubpathEnd> v;
    for (std::size_t i = 0; i < count; ++i) v.push_back(onBox(rng));
    return v;
}

std::vector<std::uint32_t> labelsOf(const Centroids& centroids, std::span<const SubpathEnd> of) {
    std::vector<std::uint32_t> labels;
    for (const SubpathEnd& e : of) labels.push_back(centroids.nearest(e));
    return labels;
}

TEST(SubpathEnd, normalIsOnTheSideOfThePredecessor) {
    const SubpathEnd e = subpathEnd({0, 0, 0}, {0, 0, 1}, {0, 3, -4}, false);
    EXPECT_EQ(e.normal(), (Vec3{0, 0, -1}));
    EXPECT_NEAR(e.direction().y, 0.6, 1e-6);
    const SubpathEnd sky = subpathEnd({5, 5, 5}, {0, 1, 0}, {0, 1, 0}, true);
    EXPECT_EQ(sky.direction(), (Vec3{0, 1, 0}));
    const SubpathEnd same = subpathEnd({1, 1, 1}, {0, 1, 0}, {1, 1, 1}, false);
    EXPECT_EQ(same.direction(), Vec3{});
}

TEST(Centroids, nearestIsTheLeastByEquation18) {
    const std::vector<SubpathEnd> centres = ends(130, 1), asked = ends(300, 2);
    constexpr double kSigma2 = 1.7;
    const Centroids centroids(centres, float(kSigma2));
    for (const SubpathEnd& e : asked) {
        const auto d = [&](const SubpathEnd& c) {
            return double(lengthSquared(c.position() - e.position())) +
                   kSigma2 * (1 - double(dot(c.normal(), e.normal()))) +
                   0.05 * kSigma2 * (1 - double(dot(c.direction(), e.direction())));
        };
        const std::uint32_t found = centroids.nearest(e);
        EXPECT_NEAR(double(centroids.distance(found, e)), d(centres[found]), 1e-4);
        for (const SubpathEnd& c : centres) EXPECT_GE(d(c), d(centres[found]) - 1e-4);

        const std::vector<std::uint32_t> some = centroids.nearest(e, 9),
                                         all = centroids.nearest(e, 1000);
        ASSERT_EQ(some.size(), 9u);
        ASSERT_EQ(all.size(), centres.size());
        EXPECT_EQ(some[0], found);
        EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin()));
        for (std::size_t n = 1; n < all.size(); ++n) {
            EXPECT_GE(d(centres[all[n]]), d(centres[all[n - 1]]) - 1e-4);
        }
        EXPECT_EQ(std::set<std::uint32_t>(all.begin(), all.end()).size(), centres.size());
    }
    EXPECT_EQ(Centroids().nearest(asked[0]), 0u);
    // A larger weight of directions adds to the distance in proportion, and changes many nearest
    // centroids.
    const Centroids directed(centres, float(kSigma2), 3.0f);
    std::size_t moved = 0;
    for (const SubpathEnd& e : asked) {
        const double turned = 1 - double(dot(centres[7].direction(), e.direction()));
        EXPECT_NEAR(double(directed.distance(7, e) - centroids.distance(7, e)),
                    2.95 * kSigma2 * turned, 1e-4);
        moved += directed.nearest(e) != centroids.nearest(e);
    }
    EXPECT_GT(moved, asked.size() / 4);
}

TEST(Centroids, areDrawnByWeightAndDiffer) {
    const std::vector<SubpathEnd> all = ends(1000, 3);
    std::vector<float> weights(all.size(), 1.0f);
    weights[7] = 500.0f;  // would be drawn many times over
    weights[8] = std::numeric_limits<float>::quiet_NaN();
    weights[9] = 0.0f;
    Rng rng(1, 0, StreamKind::User, 0);
    const auto drawn = drawCentroids(all, weights, 100, rng);
    EXPECT_GT(drawn.size(), 50u);
    EXPECT_LE(drawn.size(), 100u);
    std::set<std::array<float, 9>> different;
    for (const SubpathEnd& e : drawn) different.insert(e.value);
    EXPECT_EQ(different.size(), drawn.size());
    EXPECT_TRUE(different.contains(all[7].value));
    EXPECT_FALSE(different.contains(all[8].value));
    EXPECT_FALSE(different.contains(all[9].value));

    EXPECT_TRUE(drawCentroids({}, {}, 10, rng).empty());
    weights.assign(all.size(), 0.0f);
    EXPECT_TRUE(drawCentroids(all, weights, 10, rng).empty());
    const std::vector<SubpathEnd> equal(50, all[0]);
    weights.assign(50, 1.0f);
    EXPECT_EQ(drawCentroids(equal, weights, 10, rng).size(), 1u);
}

TEST(Centroids, varianceIsTheLargestOfTheThree) {
    std::vector<SubpathEnd> v(3);
    for (int i = 0; i < 3; ++i) v[std::size_t(i)].value = {1000.0f, float(3 * i), float(i)};
    EXPECT_NEAR(spatialVariance(v), 6.0, 1e-4);
    EXPECT_EQ(spatialVariance({}), 0.0f);
}

/// Accuracy relative to the nearest centroids by brute force, on the samples that the tree is grown
/// from and on others.
TEST(DecisionTree, standsInForTheNearestCentroid) {
    const Centroids centroids(ends(100, 4), 1.3f);
    const std::vector<SubpathEnd> train = ends(100000, 5), heldOut = ends(20000, 6);
    const auto labels = labelsOf(centroids, train), truth = labelsOf(centroids, heldOut);
    const DecisionTree tree = growTree(train, labels, 100);
    EXPECT_GT(treeAccuracy(tree, train, labels), 0.97);
    EXPECT_GT(treeAccuracy(tree, heldOut, truth), 0.85);
    EXPECT_LE(tree.depth(), DecisionTree::kMaxDepth);
    EXPECT_EQ(tree.leaves() * 2, tree.nodes().size() + 1);
    // Trees from files go through the constructor that checks.
    const DecisionTree again({tree.nodes().begin(), tree.nodes().end()}, 100);
    for (const SubpathEnd& e : heldOut) EXPECT_EQ(again(e), tree(e));
}

/// The leaf's label, by a descent through the nodes as files store them.
std::uint32_t leafOf(const DecisionTree& tree, const SubpathEnd& end) {
    DecisionTree::Node n = tree.nodes()[0];
    while (!n.isLeaf()) {
        const float asked = end.value[n.code & DecisionTree::kLeaf];
        n = tree.nodes()[n.index() + (asked < n.threshold ? 0 : 1)];
    }
    return n.index();
}

TEST(DecisionTree, descentsInTurnEndWhereEachEndsAlone) {
    const std::vector<SubpathEnd> grownOn = ends(20000, 9);
    const Centroids many(ends(100, 10), 1.3f), few(ends(5, 11), 1.3f);
    const DecisionTree trees[] = {growTree(grownOn, labelsOf(many, grownOn), 100),
                                  growTree(grownOn, labelsOf(few, grownOn), 5), DecisionTree()};
    std::vector<SubpathEnd> asked = ends(3000, 12);
    asked[1].value.fill(std::numeric_limits<float>::quiet_NaN());
    for (std::size_t together = 1, next = 0; next < asked.size(); together = together % 19 + 1) {
        std::vector<DecisionTree::Descent> descents{DecisionTree::Descent(77)};
        std::vector<std::uint32_t> expected{77};
        for (std::size_t n = 0; n < together && next < asked.size(); ++n, ++next) {
            const DecisionTree& tree = trees[next % 3];
            descents.emplace_back(tree, asked[next]);
            expected.push_back(leafOf(tree, asked[next]));
            EXPECT_EQ(tree(asked[next]), expected.back());
        }
        finish(descents);
        for (std::size_t n = 0; n < descents.size(); ++n) {
            EXPECT_EQ(descents[n].label(), expected[n]);
        }
    }
}

TEST(DecisionTree, endsOnDegenerateSamples) {
    EXPECT_EQ(growTree({}, {}, 1)(SubpathEnd{}), 0u);
    // The ends are all equal, but their labels are not: the most frequent label wins.
    const std::vector<SubpathEnd> equal(5, ends(1, 7)[0]);
    const DecisionTree tree = growTree(equal, std::vector<std::uint32_t>{2, 1, 2, 0, 2}, 3);
    EXPECT_EQ(tree.nodes().size(), 1u);
    EXPECT_EQ(tree(equal[0]), 2u);
    // Two values that are neighbouring floats.
    std::vector<SubpathEnd> close(2, equal[0]);
    close[1].value[0] = std::nextafter(close[0].value[0], 10.0f);
    const DecisionTree parted = growTree(close, std::vector<std::uint32_t>{0, 1}, 2);
    EXPECT_EQ(parted(close[0]), 0u);
    EXPECT_EQ(parted(close[1]), 1u);
    // With NaN, the tree still grows, and every look-up ends.
    std::vector<SubpathEnd> bad = ends(1000, 8);
    std::vector<std::uint32_t> labels;
    for (std::size_t i = 0; i < bad.size(); ++i) {
        if (i % 3 == 0) bad[i].value[i % 9] = std::numeric_limits<float>::quiet_NaN();
        labels.push_back(std::uint32_t(i % 7));
    }
    const DecisionTree grown = growTree(bad, labels, 7);
    for (const SubpathEnd& e : bad) EXPECT_LT(grown(e), 7u);
}

TEST(DecisionTree, refusesNodesThatLeadNowhere) {
    using Node = DecisionTree::Node;
    const Node leaf{0, DecisionTree::kLeaf};
    const auto refuses = [](std::vector<Node> nodes) {
        EXPECT_THROW(DecisionTree(std::move(nodes), 1), std::invalid_argument);
    };
    refuses({});
    refuses({{0, 1u << 4 | DecisionTree::kLeaf}});                    // a label too large
    refuses({{0, 0u << 4}, leaf, leaf});                              // its own child
    refuses({{0, 2u << 4}, leaf, leaf});                              // a child outside
    refuses({{0, 1u << 4 | 9u}, leaf, leaf});                         // not an attribute
    refuses({{0, 1u << 4}, {0, 3u << 4}, {0, 3u << 4}, leaf, leaf});  // children of two
    refuses({{0, 0xffffffffu}});
}

TEST(LightCells, areSharedOutByPower) {
    SceneBuilder b;
    b.add(quad({0, 0, 0}, {9, 0, 0}, {0, 0, 9}));
    const std::uint32_t strong = b.add(emitter(Rgb(50.0f))), weak = b.add(emitter(Rgb(0.2f)));
    b.add(triangle({0, 3, 0}, {1, 3, 0}, {0, 3, 1}, strong));
    for (int i = 0; i < 20; ++i) {
        const auto x = float(i) * 0.1f;
        b.add(triangle({x, 4, 0}, {x + 1, 4, 0}, {x, 4, 1}, weak));
    }
    b.add(pointLight({2, 2, 2}, Rgb(1.0f)));
    b.add(directionalLight({0, -1, 0}, Rgb(1e-3f)));
    const auto scene = b.build();
    for (const std::uint32_t wanted : {1u, 4u, 20u, 200u}) {
        const LightCells cells(scene->lights(), wanted);
        ASSERT_EQ(cells.blocks().size(), scene->lights().size());
        EXPECT_GE(cells.count(), 1u);
        EXPECT_LE(cells.count(), wanted + 1);
        std::vector<double> worth(cells.count(), 0.0);
        for (std::uint32_t i = 0; i < scene->lights().size(); ++i) {
            const LightCells::Block& block = cells.blocks()[i];
            const std::uint32_t n = std::uint32_t(block.rows) * block.columns;
            // Lights without extent are not divided.
            if (!isHittable(scene->lights().kind(i))) {
                EXPECT_EQ(n, 1u);
            }
            for (std::uint32_t c = 0; c < n; ++c) {
                worth.at(block.first + c) += scene->lights().pmf(i) / n;
            }
        }
        for (const double w : worth) EXPECT_GT(w, 0.0);
    }
    // With 20 cells, every light but the strong lamp is worth less than a cell, and such lights
    // share cells.
    EXPECT_LT(LightCells(scene->lights(), 20).count(), 21u);
}

TEST(LightCells, areEvenOnATriangle) {
    const LightCells cells(std::vector<LightCells::Block>{{0, 4, 6}, {24}});
    EXPECT_EQ(cells.count(), 25u);
    std::vector<int> hits(25, 0);
    Rng rng(9, 0, StreamKind::User, 0);
    constexpr int kPoints = 240000;
    for (int n = 0; n < kPoints; ++n) {
        float u = rng.uniform(), v = rng.uniform();
        if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
        PathVertex y;
        y.kind = VertexKind::LightSource;
        y.light = 0;
        y.lightUv = {u, v};
        ++hits[cells.cellOf(y)];
    }
    // 24 cells; 500 is 5 standard deviations of a count.
    for (int c = 0; c < 24; ++c) EXPECT_NEAR(hits[std::size_t(c)], 10000, 500) << c;
    PathVertex other;
    other.light = 1;
    EXPECT_EQ(cells.cellOf(other), 24u);
    other.light = 7;  // a light that the table does not have
    EXPECT_EQ(cells.cellOf(other), 0u);
    EXPECT_THROW(LightCells(std::vector<LightCells::Block>{{0, 0, 1}}), std::invalid_argument);
}

TEST(LightCells, areEvenOnTheSky) {
    const LightCells cells(std::vector<LightCells::Block>{{0, 3, 8}});
    std::vector<int> hits(24, 0);
    Rng rng(10, 0, StreamKind::User, 0);
    for (int n = 0; n < 240000; ++n) {
        PathVertex y;
        y.kind = VertexKind::Infinite;
        y.light = 0;
        // Uniform height and azimuth are uniform on the sphere.
        const double height = 2.0 * rng.uniformDouble() - 1.0;
        const double turn = 6.283185307179586 * rng.uniformDouble();
        const double r = std::sqrt(1.0 - height * height);
        y.position = {float(r * std::cos(turn)), float(height), float(r * std::sin(turn))};
        ++hits[cells.cellOf(y)];
    }
    for (const int h : hits) EXPECT_NEAR(h, 10000, 500);
}

}  // namespace
}  // namespace lacuna::test
