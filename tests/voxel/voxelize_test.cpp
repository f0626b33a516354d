// Conservative voxelization: exact at touching, closed against leaks; parts, distances, domain.
#include "libcore/voxel/voxelize.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/voxel/components.h"
#include "libcore/voxel/exact_overlap.h"
#include "libcore/voxel/reach.h"
#include "libcore/voxel/surface_distance.h"
#include "tests/fixtures/never.h"
#include "tests/scene/scene_builder.h"
#include "tests/stability.h"
#include "tests/voxel/triangles.h"

namespace lacuna::test {
namespace {

TEST(Overlap, isExact) {
    Rng rng(1, 0, StreamKind::User, 0);
    int together = 0;
    for (int n = 0; n < 200000; ++n) {
        // On a coarse lattice, most triangles touch the box's faces, edges and corners exactly. The
        // small shifts move them just off these.
        const bool shifted = n % 2 == 0;
        const auto coordinate = [&] {
            const double shift = shifted ? (rng.uniformDouble() - 0.5) * 1e-15 : 0.0;
            return 0.5 * double(int(rng.below(13)) - 6) + shift;
        };
        const TriangleD t{Vec3d{coordinate(), coordinate(), coordinate()},
                          Vec3d{coordinate(), coordinate(), coordinate()},
                          Vec3d{coordinate(), coordinate(), coordinate()}};
        const Vec3d normal = cross(t[1] - t[0], t[2] - t[0]);
        if (lengthSquared(normal) < 1e-6) continue;  // CGAL needs a plane
        const Vec3d low{-1, -1, -1}, high{1, 1, 1};
        const bool expected = overlapsByCgal(t, low, high);
        ASSERT_EQ(overlaps(t, low, high), expected) << n;
        together += expected ? 1 : 0;
    }
    EXPECT_GT(together, 20000);
}

TEST(Voxelize, everyVoxelThatATriangleTouches) {
    const std::vector<Triangle> triangles =
        trianglesOf(box({-1, -1, -1}, {1, 1, 1}), rotation({1, 2, 3}, 25));
    const VoxelShape shape = latticeOver({{-2, -2, -2}, {2, 2, 2}}, 24);
    std::vector<VoxelState> state(shape.count(), VoxelState::Empty);
    const ThreadPool pool(2);
    voxelize(triangles, shape, state, pool, kNever);
    for (std::size_t i = 0; i < state.size(); ++i) {
        const VoxelIndex v = shape.indexOf(i);
        bool touched = false;
        for (const Triangle& t : triangles) {
            touched |= overlapsByCgal({Vec3d(t[0]), Vec3d(t[1]), Vec3d(t[2])}, shape.corner(v),
                                      shape.corner({v[0] + 1, v[1] + 1, v[2] + 1}));
        }
        ASSERT_EQ(state[i] == VoxelState::Solid, touched) << i;
    }
    // A closed box: inside and outside do not even share a corner.
    EXPECT_EQ(Components(shape, state, {}, Connectivity::Corners).count(), 2u);
}

TEST(Voxelize, noLeakThroughSheetsInAnyDirection) {
    const ThreadPool pool(2);
    int leaks = 0;
    for (int n = 0; n < 40; ++n) {
        Rng rng(2, 0, StreamKind::User, std::uint64_t(n));
        const Vec3d axis{rng.uniformDouble() - 0.5, rng.uniformDouble() - 0.5,
                         rng.uniformDouble() - 0.5};
        const Affine turn = rotation(axis, 360 * rng.uniformDouble());
        const auto sheet = trianglesOf(quad({-9, -9, 0.01f}, {18, 0, 0}, {0, 18, 0}), turn);
        const VoxelShape shape = latticeExactlyOver({{-3, -3, -3}, {3, 3, 3}}, 17);
        std::vector<VoxelState> state(shape.count(), VoxelState::Empty);
        voxelize(sheet, shape, state, pool, kNever);
        const std::size_t sides = Components(shape, state, {}, Connectivity::Corners).count();
        EXPECT_EQ(sides, 2u) << n;
        leaks += sides < 2 ? 1 : 0;
    }
    stabilityCase("voxel-thin-walls", double(leaks), "of 40 sheets leak");
}

TEST(Voxelize, wallsOfTheDomainAreOneVoxelThick) {
    const std::vector<Triangle> triangles = trianglesOf(box({0, 0, 0}, {4, 2, 3}));
    const VoxelShape shape = latticeOver(boundsOf(triangles), 33);
    EXPECT_EQ(shape.size[0], 33);
    std::vector<VoxelState> state(shape.count(), VoxelState::Empty);
    voxelize(triangles, shape, state, ThreadPool(1), kNever);
    std::size_t empty = 0;
    for (const VoxelState s : state) empty += s == VoxelState::Empty ? 1 : 0;
    EXPECT_EQ(empty, std::size_t(shape.size[0] - 2) * std::size_t(shape.size[1] - 2) *
                         std::size_t(shape.size[2] - 2));
}

TEST(Voxelize, anInterruptEndsIt) {
    const std::atomic<bool> cancelled{true};
    const std::vector<Triangle> triangles = trianglesOf(box({0, 0, 0}, {4, 2, 3}));
    const VoxelShape shape = latticeOver(boundsOf(triangles), 33);
    std::vector<VoxelState> state(shape.count(), VoxelState::Empty);
    try {
        voxelize(triangles, shape, state, ThreadPool(1), cancelled);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.exitCode(), 130);
    }
}

TEST(SurfaceDistance, isExact) {
    const ThreadPool pool(2);
    const std::vector<Triangle> triangles =
        trianglesOf(box({-1, -1, -1}, {1, 1, 1}), rotation({1, 2, 3}, 25));
    const Affine back = rotation({1, 2, 3}, -25);
    const SurfaceDistance surface(triangles, pool);
    Rng rng(3, 0, StreamKind::User, 0);
    for (int n = 0; n < 2000; ++n) {
        const Vec3d p{6 * rng.uniformDouble() - 3, 6 * rng.uniformDouble() - 3,
                      6 * rng.uniformDouble() - 3};
        const Vec3d q = back.point(p);
        const Vec3d out = max(max(q, -q) - Vec3d{1, 1, 1}, Vec3d{});
        const double inside = 1.0 - std::max({std::fabs(q.x), std::fabs(q.y), std::fabs(q.z)});
        const double expected = inside > 0 ? inside : length(out);
        EXPECT_NEAR(surface(p, std::numeric_limits<double>::infinity()), expected, 1e-6);
        EXPECT_NEAR(surface(p, expected * 1.5 + 0.01), expected, 1e-6);
    }
}

/// A closed room of 4 m on a ground of 400 m.
SceneBuilder roomOnALargeGround() {
    SceneBuilder b;
    b.add(box({-2, 0, -2}, {2, 3, 2}, 0, true));
    b.add(quad({-200, -0.01f, -200}, {0, 0, 400}, {400, 0, 0}));
    b.add(lookAt({0, 1.5, 1.5}, {0, 1.5, 0}, 60));
    return b;
}

TEST(Domain, aLargeGroundDoesNotEatTheResolution) {
    const auto scene = roomOnALargeGround().build();
    const ThreadPool pool(2);
    const std::vector<Triangle> triangles = scene->blockingTriangles(pool);
    const Reach reach = traceReach(*scene, pool);
    ASSERT_FALSE(reach.camera.empty());
    const VoxelBox domain = defaultDomain(reach, boundsOf(triangles));
    EXPECT_LT(domain.high.x - domain.low.x, 4.5);
    EXPECT_GT(domain.high.x - domain.low.x, 3.9);
    EXPECT_LT(domain.high.z - domain.low.z, 4.5);
    // The empty space outside the closed room is another part, which no path reaches.
    const VoxelShape shape = latticeOver(domain, 48);
    std::vector<VoxelState> state(shape.count(), VoxelState::Empty);
    voxelize(triangles, shape, state, pool, kNever);
    const PartCounts parts = keepReachedParts(reach, shape, state);
    EXPECT_GE(parts.total, 2u);
    EXPECT_EQ(parts.reached, 1u);
}

TEST(Domain, aCameraOutsideTheGeometryWorks) {
    SceneBuilder b;
    b.add(quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}));
    b.add(quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}));
    b.add(lookAt({0, 1, 30}, {0, 1, 0}, 6));
    const auto scene = b.build();
    const ThreadPool pool(2);
    const Reach reach = traceReach(*scene, pool);
    const VoxelBox domain = defaultDomain(reach, boundsOf(scene->blockingTriangles(pool)));
    EXPECT_LT(domain.high.z, 2.0 + 1e-3);
    EXPECT_GT(domain.high.y - domain.low.y, 1.5);
}

}  // namespace
}  // namespace lacuna::test
