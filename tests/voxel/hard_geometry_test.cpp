// Geometry that is hard to voxelize: scenes of any size, walls thinner than a voxel, faces on the
// lattice, duplicate faces, needles, meshes that are no surface.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/voxel/components.h"
#include "libcore/voxel/exact_overlap.h"
#include "libcore/voxel/surface_distance.h"
#include "tests/fixtures/never.h"
#include "tests/scene/scene_builder.h"
#include "tests/stability.h"
#include "tests/voxel/triangles.h"

namespace lacuna::test {
namespace {

const ThreadPool& threads() {
    static const ThreadPool pool(2);
    return pool;
}

std::vector<Triangle> joined(std::vector<Triangle> a, const std::vector<Triangle>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::vector<VoxelState> statesOf(const std::vector<Triangle>& triangles, const VoxelShape& shape) {
    std::vector<VoxelState> state(shape.count(), VoxelState::Empty);
    voxelize(triangles, shape, state, threads(), kNever);
    return state;
}

std::size_t solidVoxels(const std::vector<VoxelState>& state) {
    return std::size_t(std::count(state.begin(), state.end(), VoxelState::Solid));
}

/// The number of voxels that differ from CGAL's exact predicate over all triangles.
std::size_t wrongVoxels(const std::vector<Triangle>& triangles, const VoxelShape& shape) {
    const std::vector<VoxelState> state = statesOf(triangles, shape);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < state.size(); ++i) {
        const VoxelIndex v = shape.indexOf(i);
        const Vec3d low = shape.corner(v), high = shape.corner({v[0] + 1, v[1] + 1, v[2] + 1});
        bool touched = false;
        for (const Triangle& t : triangles) {
            touched = touched || overlapsByCgal({Vec3d(t[0]), Vec3d(t[1]), Vec3d(t[2])}, low, high);
        }
        wrong += touched != (state[i] == VoxelState::Solid);
    }
    return wrong;
}

/// A lattice of 10^3 voxels of size 1 around the origin.
VoxelShape unitLattice() {
    return latticeExactlyOver({{-5, -5, -5}, {5, 5, 5}}, 10);
}

TEST(HardGeometry, sizeOfTheScene) {
    const Mesh mesh = box({-0.9f, -0.7f, -0.8f}, {1, 0.6f, 0.9f});
    const auto scaled = [&](double s) {
        return joined(
            trianglesOf(mesh, scaling({s, s, s})),
            trianglesOf(mesh, scaling({0.4 * s, 0.3 * s, 0.3 * s}) * rotation({1, 2, 3}, 25)));
    };
    const auto lattice = [&](double s) { return latticeOver({{-s, -s, -s}, {s, s, s}}, 14); };
    const std::vector<VoxelState> unit = statesOf(scaled(1), lattice(1));
    EXPECT_EQ(Components(lattice(1), unit, {}, Connectivity::Corners).count(), 3u);
    std::size_t wrong = 0;
    for (const double s : {1e-3, 1.0, 1e6}) wrong += wrongVoxels(scaled(s), lattice(s));
    EXPECT_EQ(wrong, 0u);
    const SurfaceDistance here(scaled(1), threads());
    const double unbounded = std::numeric_limits<double>::infinity();
    for (const double s : {0x1p-10, 0x1p20}) {  // exact: to the last bit
        EXPECT_EQ(statesOf(scaled(s), lattice(s)), unit) << s;
        const SurfaceDistance there(scaled(s), threads());
        for (const Vec3d& p : {Vec3d{0.1, 0.2, 0.3}, Vec3d{-3, 2, 0.7}, Vec3d{0.95, 0, 0}}) {
            EXPECT_EQ(there(p * s, unbounded), here(p, unbounded) * s) << s;
        }
    }
    stabilityCase("voxel-scale", double(wrong), "voxels wrong");
}

/// The two sides of a closed wall stay two parts, however thin it is.
TEST(HardGeometry, wallsThinnerThanAVoxel) {
    std::size_t leaks = 0;
    for (const float thickness : {0.3f, 1e-3f, 1e-6f}) {
        for (int n = 0; n < 12; ++n) {
            Rng rng(7, 0, StreamKind::User, std::uint64_t(n));
            const Vec3d axis{rng.uniformDouble() - 0.5, rng.uniformDouble() - 0.5,
                             rng.uniformDouble() - 0.5};
            const float at = 2 * rng.uniform() - 1;
            const auto wall = trianglesOf(box({-20, -20, at}, {20, 20, at + thickness}),
                                          rotation(axis, 360 * rng.uniformDouble()));
            const auto state = statesOf(wall, unitLattice());
            leaks += Components(unitLattice(), state, {}, Connectivity::Corners).count() != 2;
        }
    }
    EXPECT_EQ(leaks, 0u);
    stabilityCase("voxel-thin-walls", double(leaks), "walls leak");
}

TEST(HardGeometry, facesOnTheLattice) {
    const VoxelShape shape = unitLattice();
    // A sheet on a lattice plane touches the voxels on both sides. A corner on a lattice corner
    // touches those around it. An edge along a lattice line touches those around the line.
    const auto sheet = statesOf(trianglesOf(quad({-9, 2, -9}, {0, 0, 18}, {18, 0, 0})), shape);
    EXPECT_EQ(solidVoxels(sheet), 200u);
    const std::vector<Triangle> corner = {
        {Vec3{0, 0, 0}, Vec3{-0.5f, 0.25f, 0.125f}, Vec3{-0.25f, 0.5f, 0.25f}}};
    EXPECT_EQ(solidVoxels(statesOf(corner, shape)), 8u);
    const std::vector<Triangle> edge = {{Vec3{-2, 1, 1}, Vec3{2, 1, 1}, Vec3{0, 1.5f, 1.5f}}};
    // Four voxels along the line and one beyond each end, times four around it.
    EXPECT_EQ(solidVoxels(statesOf(edge, shape)), 24u);
    const std::size_t wrong = wrongVoxels(trianglesOf(box({-3, -2, -1}, {1, 2, 3})), shape) +
                              wrongVoxels(corner, shape) + wrongVoxels(edge, shape);
    EXPECT_EQ(wrong, 0u);
    stabilityCase("voxel-borders", double(wrong), "voxels wrong");
}

TEST(HardGeometry, coplanarAndDuplicateFaces) {
    const VoxelShape shape = unitLattice();
    const Affine turn = rotation({3, 1, 2}, 40);
    const auto once = trianglesOf(box({-3, -2, -1}, {1, 2, 3}), turn);
    // The same faces again, reversed, and a part of one of them.
    auto again = once;
    for (const Triangle& t : once) again.push_back({t[2], t[1], t[0]});
    const Triangle& whole = once[0];
    const Vec3 middle = (whole[1] + whole[2]) * 0.5f;
    again.push_back({whole[0], whole[1], middle});
    const auto expected = statesOf(once, shape), found = statesOf(again, shape);
    std::size_t different = 0;
    for (std::size_t i = 0; i < found.size(); ++i) different += found[i] != expected[i];
    EXPECT_EQ(different, 0u);
    const SurfaceDistance a(once, threads()), b(again, threads());
    for (std::size_t i = 0; i < found.size(); i += 7) {
        const Vec3d p = shape.centre(shape.indexOf(i));
        const double unbounded = std::numeric_limits<double>::infinity();
        EXPECT_NEAR(a(p, unbounded), b(p, unbounded), 1e-6);
    }
    stabilityCase("voxel-duplicates", double(different), "voxels differ");
}

/// Edges with three or more faces, faces through each other, holes: only the triangles count.
TEST(HardGeometry, meshesThatAreNoSurface) {
    std::size_t wrong = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        Rng rng(8, 0, StreamKind::User, seed);
        const auto point = [&] {
            return Vec3{12 * rng.uniform() - 6, 12 * rng.uniform() - 6, 12 * rng.uniform() - 6};
        };
        const Vec3 a = point(), b = point();
        std::vector<Triangle> soup;
        for (int i = 0; i < 5; ++i) soup.push_back({a, b, point()});
        for (int i = 0; i < 5; ++i) soup.push_back({point(), point(), point()});
        wrong += wrongVoxels(soup, unitLattice());
    }
    EXPECT_EQ(wrong, 0u);
    stabilityCase("voxel-no-surface", double(wrong), "voxels wrong");
}

double distanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
    const Vec3d ab = b - a;
    const double l = lengthSquared(ab);
    const double t = l > 0 ? std::clamp(dot(p - a, ab) / l, 0.0, 1.0) : 0.0;
    return length(p - a - ab * t);
}

/// Triangles whose width is 1e-7 of their length or zero, as in instances far from their origin.
/// They count as the segment, for the voxels that they touch and for distances.
TEST(HardGeometry, needles) {
    const VoxelShape shape = unitLattice();
    const double unbounded = std::numeric_limits<double>::infinity();
    double worst = 0;
    std::size_t wrong = 0;
    for (int n = 0; n < 300; ++n) {
        Rng rng(9, 0, StreamKind::User, std::uint64_t(n));
        const auto point = [&] {
            if (n % 5 > 0) {
                return Vec3{8 * rng.uniform() - 4, 8 * rng.uniform() - 4, 8 * rng.uniform() - 4};
            }
            // Multiples of 1/2, so that a third point between two is exactly on their line.
            return Vec3{0.5f * float(rng.below(17)) - 4, 0.5f * float(rng.below(17)) - 4,
                        0.5f * float(rng.below(17)) - 4};
        };
        const Vec3 a = point(), b = n % 3 == 2 ? a : point();
        // The third corner is next to the second, between the two, or all three are one point.
        const float width = n % 2 == 0 ? 8e-7f : 0.0f;
        const Vec3 c = (n % 3 == 1 ? (a + b) * 0.5f : b) + Vec3{0, width, 0};
        const std::vector<Triangle> needle = {{a, b, c}};
        const auto state = statesOf(needle, shape);
        const SurfaceDistance surface(needle, threads());
        for (std::size_t i = 0; i < state.size(); ++i) {
            const VoxelIndex v = shape.indexOf(i);
            const Vec3d centre = shape.centre(v);
            const double d = distanceToSegment(centre, Vec3d(a), Vec3d(b));
            const bool solid = state[i] == VoxelState::Solid;
            // A voxel contains its ball of radius 1/2, and lies in its ball of radius sqrt(3)/2.
            wrong += (d < 0.5 - 1e-5 && !solid) || (d > 0.5 * std::sqrt(3.0) + 1e-5 && solid);
            const double found = surface(centre, unbounded);
            if (!(std::fabs(found - d) <= worst)) worst = std::fabs(found - d);
        }
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_LT(worst, 1e-6);
    stabilityCase("voxel-needles", worst, "off the distance, at most");
}

}  // namespace
}  // namespace lacuna::test
