// Cache points of the finite space: which point serves a vertex, and which values one set takes
// over from earlier ones.
#include "libcore/resampling/cache_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libcore/base/parallel.h"
#include "tests/fixtures/finite_space.h"
#include "tests/fixtures/fixed_eye_path.h"

namespace lacuna::test {
namespace {

struct Space {
    FiniteSpace space{3};
    ThreadPool threads{2};
    IterationStatistics statistics;
    IterationContext context{space, threads, 5, 0, 10, statistics};
};

double distance2(Vec3 a, Vec3 b) {
    return lengthSquared(Vec3d(a) - Vec3d(b));
}

double nearestDistance2(const CachePoints& points, Vec3 p) {
    double least = 1e300;
    for (std::uint32_t j = 0; j < points.size(); ++j) {
        least = std::min(least, distance2(points.position(j), p));
    }
    return least;
}

TEST(CachePoints, areConnectableVerticesOfEyePaths) {
    Space s;
    const CachePoints points(s.context, 4.0, 3, 0);
    ASSERT_GT(points.size(), 40u);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const Subpath eye = points.eye(i);
        EXPECT_TRUE(eye[1].connectable());
        EXPECT_EQ(eye[0].index + 1, eye[1].index);
        EXPECT_GE(eye[1].index, 1);
    }
    // Another generation makes another set; the same one makes the same set.
    const CachePoints other(s.context, 4.0, 3, 1), again(s.context, 4.0, 3, 0);
    ASSERT_EQ(again.size(), points.size());
    bool different = other.size() != points.size();
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(again.position(i), points.position(i));
        different |= i < other.size() && !(other.position(i) == points.position(i));
    }
    EXPECT_TRUE(different);
}

TEST(CachePoints, areServedByTheNearestAndItsNeighbours) {
    Space s;
    for (const double density : {0.01, 4.0}) {  // one path: fewer points than neighbours
        const CachePoints points(s.context, density, 12, 0);
        ASSERT_FALSE(points.empty());
        PathVertex z;
        z.position = points.position(0) + Vec3{0.1f, -0.2f, 0.3f};
        const std::uint32_t serving = points.serving(z, kNone);
        EXPECT_NEAR(distance2(points.position(serving), z.position),
                    nearestDistance2(points, z.position), 1e-6);
        const auto label = std::uint32_t(points.size() - 1);
        EXPECT_EQ(points.serving(z, label), label) << "a label is believed";
        z.kind = VertexKind::Surface;
        points.labelAsEye({&z, 1});
        EXPECT_EQ(z.asEye, kNone) << "nothing is connected here";
        std::vector<PathVertex> eye(points.eye(0).begin(), points.eye(0).end());
        points.labelAsEye(eye);
        EXPECT_EQ(eye[1].asEye, points.serving(eye[1], kNone));

        for (std::uint32_t i = 0; i < points.size(); ++i) {
            const auto around = points.around(i);
            ASSERT_EQ(around.size(), std::min<std::size_t>(12, points.size()));
            EXPECT_EQ(around[0], i);
            std::vector<double> found, all;
            for (const std::uint32_t j : around) {
                found.push_back(distance2(points.position(i), points.position(j)));
            }
            for (std::uint32_t j = 0; j < points.size(); ++j) {
                all.push_back(distance2(points.position(i), points.position(j)));
            }
            std::sort(all.begin(), all.end());
            for (std::size_t j = 0; j < found.size(); ++j) EXPECT_NEAR(found[j], all[j], 1e-6);
            EXPECT_GT(points.inverseSquareLimit(i), 0.0);
            EXPECT_TRUE(std::isfinite(points.inverseSquareLimit(i)));
        }
    }
    const CachePoints none;
    EXPECT_EQ(none.serving(PathVertex{}, kNone), kNone);
    EXPECT_TRUE(none.around(kNone).empty());
}

/// Lens, mirror, and a surface that scatters.
class BehindAMirror final : public FixedEyePath {
  public:
    BehindAMirror() {
        Bsdf::Parameters mirror, grey;
        mirror.baseColor = grey.baseColor = Rgb(0.5f);
        mirror.metallic = 1.0f;
        mirror.roughness = 0.0f;
        addLens({0, 0, 0});
        addSurface({1, 0, 0}, mirror, ScatterEvent::DeltaReflection);
        addSurface({2, 0, 0}, grey);
    }
};

TEST(CachePoints, areNotOnMirrors) {
    const ThreadPool threads(1);
    const BehindAMirror space;
    IterationStatistics statistics;
    IterationContext context{space, threads, 5, 0, 3, statistics};
    const CachePoints points(context, 1.0, 3, 0);
    ASSERT_EQ(points.size(), 3u) << "three paths, and nothing is connected at a mirror";
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(points.position(i).x, 2.0f) << "what is seen in the mirror";
        EXPECT_EQ(points.eye(i)[0].index, 1) << "with its predecessor";
    }
}

/// One eye path from above to a surface at the origin.
class OnePoint final : public FixedEyePath {
  public:
    explicit OnePoint(float transmission) {
        Bsdf::Parameters p;
        p.baseColor = Rgb(0.5f);
        p.roughness = 0.5f;
        p.transmission = transmission;
        addLens({0, 1, 2});
        addSurface({0, 0, 0}, p);
    }
};

TEST(CachePoints, weightsDoNotCountOnWhatIsBehindASurface) {
    const ThreadPool threads(1);
    PathVertex light;
    light.kind = VertexKind::LightSource;
    const double geometry = 0.1;  // at the eye vertex; less than at the point
    for (const float transmission : {0.0f, 1.0f}) {
        const OnePoint space(transmission);
        IterationStatistics statistics;
        IterationContext context{space, threads, 5, 0, 1, statistics};
        const CachePoints points(context, 1.0, 3, 0);
        ASSERT_EQ(points.size(), 1u);
        light.position = {0.1f, -0.3f, 1.5f};
        EXPECT_DOUBLE_EQ(points.trustedGeometry(0, light, geometry), geometry) << transmission;
        light.position.z = -1.5f;
        EXPECT_DOUBLE_EQ(points.trustedGeometry(0, light, geometry),
                         transmission > 0.0f ? geometry : 1e-4 * geometry)
            << transmission;
    }
}

/// The distance to the neighbours limits 1 / d^2. Cosines are not limited.
TEST(CachePoints, limitLengthsAndNoCosines) {
    Space s;
    const CachePoints points(s.context, 4.0, 3, 0);
    PathVertex near, sun;
    near.kind = VertexKind::LightSource;
    sun.kind = VertexKind::Infinite;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const double limit = points.inverseSquareLimit(i);
        EXPECT_EQ(points.limited(i, near, 2 * limit), limit);
        EXPECT_EQ(points.limited(i, near, 0.5 * limit), 0.5 * limit);
        EXPECT_EQ(points.limited(i, near, limit, 0.25), 0.25 * limit);
        EXPECT_EQ(points.limited(i, sun, 2 * limit), 2 * limit);
        EXPECT_EQ(points.limited(i, sun, limit, 0.25), limit);
    }
}

TEST(EarlierValues, areMeansOverSetsOfMeansOverNeighbours) {
    Space s;
    EarlierValues earlier(2, 2, 1);
    const CachePoints now(s.context, 1.0, 3, 9);
    for (const double v : earlier.at(now, s.threads)) EXPECT_EQ(v, 0.0);
    earlier.add(CachePoints(), {});

    // The value of a point is a function of its position, so ties do not matter.
    const auto value = [](Vec3 p, int set) {
        return double(set) + double(p.x) + 2.0 * double(p.y);
    };
    const auto add = [&](int set) {
        CachePoints points(s.context, 4.0, 3, std::uint32_t(set));
        std::vector<double> values;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            values.push_back(value(points.position(i), set));
            values.push_back(7.0);
        }
        earlier.add(std::move(points), std::move(values));
    };
    const auto expected = [&](Vec3 p, int set) {
        const CachePoints points(s.context, 4.0, 3, std::uint32_t(set));
        for (std::uint32_t j = 0; j < points.size(); ++j) {
            if (distance2(points.position(j), p) == nearestDistance2(points, p)) {
                return value(points.position(j), set);
            }
        }
        return 0.0;
    };
    for (const int set : {0, 1, 2}) {
        add(set);
        const std::vector<double> q = earlier.at(now, s.threads);
        ASSERT_EQ(q.size(), 2 * now.size());
        for (std::uint32_t i = 0; i < now.size(); ++i) {
            const Vec3 p = now.position(i);
            // Two sets are kept.
            const double truth =
                set == 0 ? expected(p, 0) : 0.5 * (expected(p, set - 1) + expected(p, set));
            EXPECT_NEAR(q[2 * i], truth, 1e-9);
            EXPECT_NEAR(q[2 * i + 1], 7.0, 1e-12);
        }
    }
}

}  // namespace
}  // namespace lacuna::test
