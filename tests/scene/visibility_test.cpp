// Shadow rays and rays that leave a surface: no leaks, and no surface shadows itself.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/scene/sphere_bins.h"
#include "tests/scene/surface_points.h"

namespace lacuna::test {
namespace {

struct Point {
    Vec3 position, ng;
};

/// Points on all sides of a box mesh, found by rays from its inside.
std::vector<Point> pointsInside(const Scene& scene, Vec3d middle, Rng& rng, int n) {
    std::vector<Point> points;
    RayTally tally;
    while (int(points.size()) < n) {
        const auto hit =
            scene.intersect(Vec3(middle), {}, randomDirection(rng), RayKind::Camera, tally);
        EXPECT_TRUE(hit) << "a leak";
        if (!hit) break;
        points.push_back({hit->position, hit->ng});
    }
    return points;
}

struct Room {
    const char* name;
    Affine toWorld;
    Placement placement;
};

std::vector<Room> rooms() {
    const Affine turned = rotation({1, 2, 3}, 50) * scaling({1, 0.7, 0.4});
    return {{"axis-parallel", {}, Placement::Baked},
            {"turned", turned, Placement::Baked},
            {"turned, instanced", turned, Placement::Instanced},
            {"mirrored, sheared, instanced", transforms()[5].toWorld, Placement::Instanced}};
}

TEST(Visibility, OnlyTheLensPassesWhatIsHiddenFromTheCamera) {
    for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
        SceneBuilder b;
        lacuna::Material hidden = matte(Rgb(0.5f));
        hidden.hiddenFromCamera = true;
        Mesh pane = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
        pane.material = b.add(hidden);
        place(b, pane, {}, placement);
        const auto scene = b.build();
        const Vec3 front(Vec3d{0.1, 0.1, 1} - scene->centre());
        const Vec3 back(Vec3d{0.1, 0.1, -1} - scene->centre());
        RayTally tally;
        EXPECT_FALSE(scene->trace(front, {}, back - front, RayKind::Camera, tally));
        EXPECT_TRUE(scene->trace(front, {}, back - front, RayKind::EyeWalk, tally));
        EXPECT_TRUE(scene->trace(front, {}, back - front, RayKind::LightWalk, tally));
        EXPECT_TRUE(scene->visible(front, {}, back, {}, RayKind::Splat, tally));
        EXPECT_FALSE(scene->visible(front, {}, back, {}, RayKind::Connection, tally));
        EXPECT_TRUE(scene->visibleToInfinity(front, {}, back - front, RayKind::Splat, tally));
        EXPECT_FALSE(scene->visibleToInfinity(front, {}, back - front, RayKind::Connection, tally));
    }
}

TEST(Visibility, ClosedBox) {
    for (const Room& room : rooms()) {
        SCOPED_TRACE(room.name);
        SceneBuilder b;
        const Mesh mesh = box({-1, -1, -1}, {1, 1, 1}, 0, true);
        place(b, mesh, room.toWorld, room.placement);
        const auto scene = b.build();
        const Vec3d middle = room.toWorld.m[3] - scene->centre();
        Rng rng(1, 0, StreamKind::User, 0);
        const std::vector<Point> points = pointsInside(*scene, middle, rng, 2000);
        RayTally tally;
        int pairs = 0, selfShadow = 0, leak = 0, edgeLeak = 0, lost = 0;
        const auto random = [&]() -> const Point& {
            return points[rng.below(unsigned(points.size()))];
        };
        for (int i = 0; i < 25'000; ++i) {
            const Point &p = random(), &q = random();
            const auto inFront = [&](const Vec3& to) { return dot(p.ng, to - p.position) > 1e-3f; };
            // Two points of a convex room see each other, unless they lie on one wall.
            if (inFront(q.position)) {
                selfShadow +=
                    !scene->visible(p.position, p.ng, q.position, q.ng, RayKind::Connection, tally);
            }
            // Nothing outside is visible through another wall.
            const Vec3 outside(middle + Vec3d(randomDirection(rng)) * 8.0);
            if (inFront(outside)) {
                ++pairs;
                leak += scene->visible(p.position, p.ng, outside, {}, RayKind::Connection, tally);
                leak += scene->visible(outside, {}, p.position, p.ng, RayKind::Splat, tally);
                leak += scene->visibleToInfinity(p.position, p.ng, outside - p.position,
                                                 RayKind::Connection, tally);
            }
            // Nor is it through edges and corners.
            Vec3d edge{1, 1, 2.0 * rng.uniformDouble() - 1};
            for (int k = 0; k < 3; ++k) edge[k] *= rng.below(2) ? 1 : -1;
            if (i % 10 == 0) edge.z = edge.z > 0 ? 1 : -1;
            for (unsigned turns = rng.below(3); turns > 0; --turns) edge = {edge.y, edge.z, edge.x};
            const Vec3d at = room.toWorld.point(edge) - scene->centre();
            const Vec3 beyond(at + (at - Vec3d(p.position)) * 0.5);
            if (inFront(Vec3(at))) {
                ++pairs;
                edgeLeak +=
                    scene->visible(p.position, p.ng, beyond, {}, RayKind::Connection, tally);
                edgeLeak += scene->visible(beyond, {}, p.position, p.ng, RayKind::Splat, tally);
            }
            // A walk never leaves the room, whatever the direction.
            const Vec3 d = randomDirection(rng);
            const auto next = scene->intersect(p.position, p.ng, dot(d, p.ng) < 0 ? -d : d,
                                               RayKind::LightWalk, tally);
            lost += !next || length(Vec3d(next->position) - middle) > 4.5;
        }
        EXPECT_GT(pairs, 25'000);
        EXPECT_EQ(selfShadow, 0);
        EXPECT_EQ(leak, 0);
        EXPECT_EQ(edgeLeak, 0);
        EXPECT_EQ(lost, 0);
    }
}

TEST(Visibility, GrazingPlane) {
    // A floor turned in several ways, and points barely above it.
    for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
        for (int turn = 0; turn < 6; ++turn) {
            const Affine m = rotation({1.0 - turn, 2, 0.3 * turn}, 37 * turn);
            SceneBuilder b;
            place(b, quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), m, placement);
            const auto scene = b.build();
            RayTally tally;
            Rng rng(2, 0, StreamKind::User, unsigned(turn));
            const Vec3d normal = m.vector({0, 1, 0});
            int shadow = 0, through = 0, rehit = 0;
            for (int i = 0; i < 4000; ++i) {
                const auto onFloor = [&] {
                    const Vec3d p{1.9 * rng.uniformDouble() - 0.95, 0,
                                  1.9 * rng.uniformDouble() - 0.95};
                    return m.point(p) - scene->centre();
                };
                const Vec3d start = onFloor();
                const auto hit = scene->intersect(Vec3(start + normal * 0.5), {}, Vec3(-normal),
                                                  RayKind::Camera, tally);
                ASSERT_TRUE(hit);
                const Vec3 p = hit->position;
                const Vec3d q = onFloor();
                const double distance = length(q - Vec3d(p));
                if (distance < 0.05) continue;
                // 89.9 degrees and flatter, but above rounding at the size of this scene.
                const double height = distance * std::pow(10.0, -2.8 - rng.uniformDouble());
                const Vec3 above(q + normal * height), below(q - normal * height);
                shadow += !scene->visible(p, hit->ng, above, {}, RayKind::Connection, tally);
                shadow += !scene->visible(above, {}, p, hit->ng, RayKind::Connection, tally);
                // A path that leaves the floor on the other side (transmission) is not blocked
                // either.
                shadow += !scene->visible(p, hit->ng, below, {}, RayKind::Connection, tally);
                // The floor lies between above and below.
                through += scene->visible(above, {}, below, {}, RayKind::Connection, tally);
                const Vec3 d = normalize(above - p);
                rehit += scene->intersect(p, hit->ng, d, RayKind::EyeWalk, tally).has_value();
                rehit += !scene->visibleToInfinity(p, hit->ng, d, RayKind::Connection, tally);
            }
            EXPECT_EQ(shadow, 0) << turn;
            EXPECT_EQ(through, 0) << turn;
            EXPECT_EQ(rehit, 0) << turn;
        }
    }
}

/// Rays that leave the boxes of `mesh` (each convex) outwards may meet another box, but not their
/// own. Rays that go inwards must find the other side of their own box. `boxSize` is the shortest
/// edge of the boxes; the longest is less than `longest`.
void checkLeaving(const Scene& scene, const Mesh& mesh, const Affine& toWorld, double boxSize,
                  double longest) {
    RayTally tally;
    Rng rng(3, 0, StreamKind::User, 0);
    int own = 0, escaped = 0, rays = 0;
    for (int i = 0; i < 4000; ++i) {
        const std::size_t triangle = rng.below(unsigned(mesh.triangles.size()));
        const double s = std::sqrt(rng.uniformDouble());
        // Not where two sides meet at an acute angle: there the offset leaves the box again.
        const double u = 0.1 + 0.7 * (1 - s), v = 0.1 + 0.7 * s * rng.uniformDouble();
        const ExactSurface e = exactSurface(mesh, triangle, toWorld, u, v);
        const Vec3d at = e.position - scene.centre();
        const auto hit = scene.intersect(Vec3(at + e.ng * (0.3 * boxSize)), {}, Vec3(-e.ng),
                                         RayKind::Camera, tally);
        if (!hit || length(Vec3d(hit->position) - at) > 0.05 * boxSize) continue;  // hidden
        ++rays;
        const Vec3d d = normalize(Vec3d(randomDirection(rng)) + e.ng * (i % 3 ? 0.0 : 0.999));
        const bool outwards = dot(d, e.ng) > 0;
        const auto next = scene.intersect(hit->position, hit->ng, Vec3(d), RayKind::EyeWalk, tally);
        const double reach = next ? length(Vec3d(next->position) - at) : 1e30;
        if (outwards) {
            own += reach < 0.2 * boxSize && std::abs(dot(Vec3d(next->ng), e.ng)) > 0.999;
            own += next && reach < 1e-3 * boxSize;
        } else {
            own += reach < 1e-3 * boxSize * std::abs(dot(d, e.ng));
            escaped += reach > 2 * longest;
        }
    }
    EXPECT_GT(rays, 2000);
    EXPECT_EQ(own, 0);
    EXPECT_EQ(escaped, 0);
}

TEST(Visibility, LeavingInstancesFarFromTheirOrigin) {
    // Two boxes far from their mesh's middle: local coordinates are large wherever the instance is,
    // even in the scene's middle.
    for (const double far : {10.0, 100.0, 1000.0}) {
        Mesh mesh = joined(box({float(-far) - 1, -1, -1}, {float(-far) + 1, 1, 1}),
                           box({float(far) - 1, -1, -1}, {float(far) + 1, 1, 1}));
        for (const double scale : {1.0, 1e-3, 1e3}) {
            for (int turn = 0; turn < 4; ++turn) {
                // Odd turns are also sheared and thin.
                const double thin = turn % 2 ? 0.2 : 1;
                const Affine linear = rotation({1, 2.0 - turn, 0.5}, 77 * turn) *
                                      scaling({scale, scale * thin, scale}) *
                                      (turn % 2 ? rotation({1, 1, 0}, 30) : Affine{});
                // The left box of one instance and the right box of the other are side by side in
                // the middle of the scene.
                Affine m = linear, other = linear;
                m.m[3] = linear.vector({far, 0, 0});
                other.m[3] = linear.vector({-far, 5, 5});
                for (const bool instanced : {true, false}) {
                    SceneBuilder b;
                    const std::uint32_t index = b.add(mesh, m);
                    if (instanced) {
                        b.instance(index, other);
                    } else {
                        b.add(mesh, other);
                    }
                    const auto scene = b.build();
                    SCOPED_TRACE(std::to_string(far) + ", scale " + std::to_string(scale) +
                                 ", turn " + std::to_string(turn) +
                                 (instanced ? ", instanced" : ", baked"));
                    checkLeaving(*scene, mesh, m, 2 * scale * thin, 2 * scale);
                }
            }
        }
    }
}

TEST(Visibility, ThinGapsStayOpen) {
    // Two plates with a gap of 1e-4 of the scene's size, and light between them.
    for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
        SceneBuilder b;
        const float gap = 4e-4f;
        const Mesh plates = joined(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}),
                                   quad({-1, gap, -1}, {2, 0, 0}, {0, 0, 2}));
        const Affine m = rotation({1, 1, 1}, 25);
        b.add(plates, m);
        if (placement == Placement::Instanced) b.instance(0, translation({0, -1, 0}) * m);
        const auto scene = b.build();
        RayTally tally;
        Rng rng(4, 0, StreamKind::User, 0);
        int closed = 0, seeThrough = 0, missed = 0;
        for (int i = 0; i < 3000; ++i) {
            const double x = 1.8 * rng.uniformDouble() - 0.9, z = 1.8 * rng.uniformDouble() - 0.9;
            const auto world = [&](Vec3d p) { return Vec3(m.point(p) - scene->centre()); };
            const Vec3 up(m.vector({0, 1, 0}));
            const double dx = 0.02 * (rng.uniformDouble() - 0.5);
            const Vec3 low = world({x, 0, z}), high = world({x + dx, gap, z});
            closed += !scene->visible(low, up, high, -up, RayKind::Connection, tally);
            const auto hit =
                scene->intersect(low, up, normalize(high - low), RayKind::EyeWalk, tally);
            missed += !hit || length(hit->position - high) > 0.02f;
            seeThrough +=
                scene->visible(low, up, world({x, 0.1, z}), {}, RayKind::Connection, tally);
        }
        EXPECT_EQ(closed, 0);
        EXPECT_EQ(missed, 0);
        EXPECT_EQ(seeThrough, 0);
    }
}

}  // namespace
}  // namespace lacuna::test
