// Positions, normals and texture coordinates of hits under every kind of transform, baked and
// instanced.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/rng.h"
#include "tests/scene/sphere_bins.h"
#include "tests/scene/surface_points.h"

namespace lacuna::test {
namespace {

/// A box whose shading normals have any length and lean up to 60 degrees away from the faces'.
Mesh softBox() {
    Mesh m = box({-0.5f, -0.4f, -0.3f}, {0.5f, 0.4f, 0.3f});
    Rng rng(1, 0, StreamKind::User, 0);
    for (std::size_t i = 0; i < m.positions.size(); ++i) {
        const Vec3 face = normalize(cross(m.positions[i / 4 * 4 + 1] - m.positions[i / 4 * 4],
                                          m.positions[i / 4 * 4 + 3] - m.positions[i / 4 * 4]));
        const Vec3 lean = randomDirection(rng) * 0.85f;
        m.normals.push_back((face + lean) * std::exp2(8 * rng.uniform() - 4));
        m.uvs[i] = {rng.uniform() * 3 - 1, rng.uniform()};
    }
    return m;
}

TEST(SurfacePoint, AgainstExactTransforms) {
    const Mesh mesh = softBox();
    for (const NamedTransform& t : transforms()) {
        for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
            SCOPED_TRACE(t.name + (placement == Placement::Baked ? ", baked" : ", instanced"));
            SceneBuilder b;
            place(b, mesh, t.toWorld, placement);
            const auto scene = b.build();
            RayTally tally;
            Rng rng(2, 0, StreamKind::User, 0);
            const double size = std::cbrt(std::abs(t.toWorld.determinant()));
            for (int i = 0; i < 1000; ++i) {
                const std::size_t triangle = rng.below(12);
                const float u = 0.02f + 0.5f * rng.uniform(), v = 0.02f + 0.4f * rng.uniform();
                const ExactSurface e = exactSurface(mesh, triangle, t.toWorld, u, v);
                const Vec3d centre = scene->centre(), at = e.position - centre;
                // From outside at an angle: a convex box hides none of its faces.
                const Vec3d from = at + (e.ng + Vec3d(randomDirection(rng)) * 0.5) * (0.1 * size);
                const auto hit = scene->intersect(Vec3(from), {}, Vec3(normalize(at - from)),
                                                  RayKind::Camera, tally);
                ASSERT_TRUE(hit);
                // The ray itself is rounded: allow for the scene's extent of 20.
                const double cosine = std::abs(dot(e.ng, normalize(at - from)));
                // On a needle of 1 x 6e-4, barycentrics are inexact, but the point stays on its plane.
                const double error = (t.name == "nearly flat" ? 2e-4 : 1e-5) / cosine;
                ASSERT_LT(length(Vec3d(hit->position) - at), error);
                ASSERT_NEAR(dot(Vec3d(hit->position) - at, e.ng), 0, 3e-6);
                ASSERT_NEAR(length(Vec3d(hit->ng)), 1, 1e-6);
                ASSERT_NEAR(length(Vec3d(hit->ns)), 1, 1e-6);
                ASSERT_GT(dot(hit->ng, hit->ns), 0.0f);
                // Corners are rounded too, which tilts small faces more.
                const double smallest = t.name == "tiny" || t.name == "nearly flat" ? 6e-5 : 0.1;
                ASSERT_LT(length(Vec3d(hit->ng) - e.ng), 4e-6 / smallest * 0.6);
                if (smallest < 0.1) continue;  // barycentrics are too inexact for the rest
                ASSERT_LT(length(Vec3d(hit->ns) - e.ns), 1e-3);
                ASSERT_NEAR(hit->uv.x, e.uv.x, 1e-3);
                ASSERT_NEAR(hit->uv.y, e.uv.y, 1e-3);
                ASSERT_EQ(hit->light, kNone);
            }
            EXPECT_EQ(tally.counts[std::size_t(RayKind::Camera)], 1000u);
            EXPECT_EQ(scene->triangleCount(), 24u);
        }
    }
}

TEST(SurfacePoint, InstancedEqualsBaked) {
    const Mesh mesh = softBox();
    for (const NamedTransform& t : transforms()) {
        SCOPED_TRACE(t.name);
        SceneBuilder baked, instanced;
        place(baked, mesh, t.toWorld, Placement::Baked);
        place(instanced, mesh, t.toWorld, Placement::Instanced);
        const auto a = baked.build(), b = instanced.build();
        ASSERT_EQ(a->centre(), b->centre());
        ASSERT_EQ(a->radius(), b->radius());
        RayTally tally;
        Rng rng(3, 0, StreamKind::User, 0);
        const double size = std::cbrt(std::abs(t.toWorld.determinant()));
        const Vec3d middle = t.toWorld.point({0, 0, 0}) - a->centre();
        int hits = 0, differentTriangle = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec3d from = middle + Vec3d(randomDirection(rng)) * (3 * size);
            const Vec3d to = middle + Vec3d(randomDirection(rng)) * (0.4 * size);
            const Vec3 d(normalize(to - from));
            const auto p = a->intersect(Vec3(from), {}, d, RayKind::Camera, tally);
            const auto q = b->intersect(Vec3(from), {}, d, RayKind::Camera, tally);
            if (p.has_value() != q.has_value() || (p && length(p->ng - q->ng) > 0.1f)) {
                ++differentTriangle;  // the ray grazes an edge
                continue;
            }
            if (!p) continue;
            ++hits;
            ASSERT_LT(length(p->position - q->position), 1e-5f / std::abs(dot(p->ng, d)));
            ASSERT_EQ(p->material, q->material);
            if (size < 0.2) continue;
            ASSERT_LT(length(p->ng - q->ng), 1e-4f);
            ASSERT_LT(length(p->ns - q->ns), 2e-3f);
            ASSERT_NEAR(p->uv.x, q->uv.x, 2e-3f);
            ASSERT_NEAR(p->uv.y, q->uv.y, 2e-3f);
        }
        EXPECT_GT(hits, 500);
        EXPECT_LE(differentTriangle, size < 0.2 ? 40 : 4);
    }
}

TEST(SurfacePoint, FlatInstances) {
    // glTF allows a scale of zero: the flattened mesh is still there.
    const Affine flat = rotation({1, 1, 0}, 40) * scaling({1, 0, 1});
    const Affine line = scaling({1, 0, 0}), point = scaling({0, 0, 0});
    SceneBuilder b;
    b.add(emitter(Rgb(1.0f)));
    Mesh m = softBox();
    m.material = 1;
    const std::uint32_t mesh = b.add(m, flat);
    b.instance(mesh, translation({3, 0, 0}) * flat);
    b.instance(mesh, translation({6, 0, 0}));
    b.instance(mesh, line);
    b.instance(mesh, point);
    const auto scene = b.build();
    // Rounding leaves some of the flattened sides a little area.
    EXPECT_GE(scene->triangleCount(), 4u + 4u + 12u);
    EXPECT_LE(scene->triangleCount(), 12u + 12u + 12u);
    EXPECT_EQ(scene->lights().size(), scene->triangleCount());
    RayTally tally;
    const Vec3d normal = normalize(rotation({1, 1, 0}, 40).vector({0, 1, 0}));
    for (const double x : {0.0, 3.0}) {
        const Vec3d at = Vec3d{x, 0, 0} + flat.vector({0.1, 0, 0.07}) - scene->centre();
        const auto hit =
            scene->intersect(Vec3(at + normal), {}, Vec3(-normal), RayKind::Camera, tally);
        ASSERT_TRUE(hit) << x;
        EXPECT_LT(length(Vec3d(hit->position) - at), 1e-5);
        EXPECT_NEAR(std::abs(dot(Vec3d(hit->ng), normal)), 1, 1e-5);
        EXPECT_GT(dot(hit->ng, hit->ns), 0.0f);
    }
}

TEST(SurfacePoint, MissingZeroAndContradictingNormals) {
    const auto hitWith = [](std::vector<Vec3> normals, Placement placement) {
        Mesh m = triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
        m.normals = std::move(normals);
        SceneBuilder b;
        place(b, m, {}, placement);
        const auto scene = b.build();
        RayTally tally;
        const auto hit = scene->intersect(Vec3(Vec3d{0.1, -0.2, 2} - scene->centre()), {},
                                          {0, 0, -1}, RayKind::EyeWalk, tally);
        EXPECT_TRUE(hit);
        return hit ? *hit : SurfacePoint{};
    };
    const Vec3 up{0, 0, 1}, tilted = normalize(Vec3{0.6f, 0, 0.8f}), zero{};
    for (const Placement p : {Placement::Baked, Placement::Instanced}) {
        for (const auto& normals : std::vector<std::vector<Vec3>>{
                 {},
                 {zero, zero, zero},
                 {up, -up, zero},  // may cancel, is never NaN
                 {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}},
                 {{1e-30f, 0, 1e-30f}, {-1e-30f, 0, 1e-30f}, {0, 0, 1e-30f}}}) {
            const SurfacePoint s = hitWith(normals, p);
            EXPECT_LT(length(s.ng - up), 1e-6f);
            EXPECT_NEAR(length(s.ns), 1.0f, 1e-6f);
            EXPECT_GT(dot(s.ns, s.ng), 0.0f);
        }
        EXPECT_LT(length(hitWith({tilted, tilted, tilted}, p).ns - tilted), 1e-5f);
        // Against the winding: they are turned over.
        EXPECT_LT(length(hitWith({-tilted, -tilted, -tilted}, p).ns - tilted), 1e-5f);
        EXPECT_LT(length(hitWith({-up, -up, -up}, p).ns - up), 1e-6f);
        // A zero normal leaves the direction to the others.
        EXPECT_LT(length(hitWith({tilted, zero, tilted}, p).ns - tilted), 1e-5f);
    }
}

TEST(SurfacePoint, SizesFarBelowOne) {
    // Float squares of a triangle's edges underflow here; its normal must not.
    for (const double size : {1e-12, 1e-9, 1e-6, 1.0, 1e6}) {
        for (const Placement p : {Placement::Baked, Placement::Instanced}) {
            SceneBuilder b;
            const std::uint32_t mesh = b.add(softBox(), scaling({size, size, size}));
            if (p == Placement::Instanced) b.instance(mesh, scaling({size, size, size}));
            const auto scene = b.build();
            RayTally tally;
            const auto hit = scene->intersect(Vec3{float(3 * size), float(0.01 * size), 0}, {},
                                              {-1, 0, 0}, RayKind::Camera, tally);
            ASSERT_TRUE(hit) << size;
            EXPECT_LT(length(hit->ng - Vec3{1, 0, 0}), 1e-5f) << size;
            EXPECT_NEAR(length(hit->ns), 1.0f, 1e-5f) << size;
            EXPECT_NEAR(hit->position.x / size, 0.5, 1e-5) << size;
        }
    }
}

/// One texel. As a normal map, it tilts by r along the image's width and by g towards its upper edge.
Texture texelOf(std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t alpha = 255) {
    Texture t;
    t.width = t.height = 1;
    t.rgba = {r, g, b, alpha};
    return t;
}

TEST(SurfacePoint, NormalMapsTiltTowardsTheImagesRightAndTop) {
    for (const NamedTransform& transform : transforms()) {
        for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
            SceneBuilder b;
            lacuna::Material m = matte(Rgb(0.5f));
            m.normalTexture = b.add(texelOf(191, 153, 255));
            m.normalScale = 0.5f;
            // u runs along +x; v, which points down in the image, along +y.
            place(b, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add(m)), transform.toWorld,
                  placement);
            const auto scene = b.build();
            const Affine& a = transform.toWorld;
            const double sign = a.determinant() < 0 ? -1 : 1;
            const Vec3d n = normalize(a.normal({0, 0, 1}) * sign);
            const Vec3d tangent = normalize(a.vector({1, 0, 0}) - n * dot(n, a.vector({1, 0, 0})));
            Vec3d up = normalize(cross(n, tangent));
            if (dot(up, a.vector({0, -1, 0})) < 0) up = -up;
            const Vec3d exact = normalize(tangent * (0.5 * (2 * 191 / 255.0 - 1)) +
                                          up * (0.5 * (2 * 153 / 255.0 - 1)) + n);
            RayTally tally;
            const Vec3d at = a.point({0.3, 0.2, 0}) - scene->centre();
            const double reach = 0.01 * length(a.vector({1, 0, 0}));
            const auto hit =
                scene->intersect(Vec3(at + n * reach), {}, Vec3(-n), RayKind::Camera, tally);
            ASSERT_TRUE(hit) << transform.name;
            // Corners are rounded by up to 2^-24 of the scene's extent of 10 on each axis.
            const double edge =
                2 * std::min(length(a.vector({1, 0, 0})), length(a.vector({0, 1, 0})));
            const double error = 1e-5 + 2 * std::sqrt(3.0) * 6e-7 / edge;
            EXPECT_LT(length(Vec3d(hit->ns) - exact), error) << transform.name;
            EXPECT_LT(length(Vec3d(hit->ng) - n), error) << transform.name;
        }
    }
}

TEST(SurfacePoint, TangentsSayHowANormalMapLies) {
    for (const NamedTransform& transform : transforms()) {
        for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
            for (const float handed : {1.0f, -1.0f}) {
                for (const float side : {1.0f, -1.0f}) {  // normals with and against the winding
                    SceneBuilder b;
                    lacuna::Material m = matte(Rgb(0.5f));
                    m.normalTexture = b.add(texelOf(191, 153, 255));
                    Mesh mesh = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add(m));
                    mesh.normals.assign(4, {0, 0, side});
                    mesh.tangents.assign(4, {-0.6f, 0.8f, 0, handed});
                    place(b, mesh, transform.toWorld, placement);
                    const auto scene = b.build();

                    // The map's frame is that of the surface before the transform.
                    const Affine& a = transform.toWorld;
                    const Vec3d right{-0.6, 0.8, 0}, along = a.vector(right);
                    const Vec3d edge = a.vector(cross(Vec3d{0, 0, side}, right) * handed);
                    const Vec3d n = normalize(a.normal({0, 0, 1}) * (a.determinant() < 0 ? -1 : 1));
                    const Vec3d tangent = normalize(along - n * dot(n, along));
                    Vec3d up = cross(n, tangent);
                    if (dot(up, edge) < 0) up = -up;
                    const Vec3d exact =
                        normalize(tangent * (2 * 191 / 255.0 - 1) + up * (2 * 153 / 255.0 - 1) + n);
                    RayTally tally;
                    const Vec3d at = a.point({0.3, 0.2, 0}) - scene->centre();
                    const double reach = 0.01 * length(a.vector({1, 0, 0}));
                    const auto hit = scene->intersect(Vec3(at + n * reach), {}, Vec3(-n),
                                                      RayKind::Camera, tally);
                    ASSERT_TRUE(hit) << transform.name;
                    // The error of the corners as above; it includes that the frame turns with ng.
                    const double size =
                        2 * std::min(length(a.vector({1, 0, 0})), length(a.vector({0, 1, 0})));
                    EXPECT_LT(length(Vec3d(hit->ns) - exact),
                              1e-5 + 2 * std::sqrt(3.0) * 6e-7 / size)
                        << transform.name << " " << handed << " " << side;
                }
            }
        }
    }
}

TEST(SurfacePoint, TangentsThatSayNothingLeaveItToTheCoordinates) {
    SceneBuilder b;
    lacuna::Material m = matte(Rgb(0.5f));
    m.normalTexture = b.add(texelOf(255, 128, 128));
    Mesh mesh = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add(m));
    mesh.normals.assign(4, {0, 0, 1});
    mesh.tangents.assign(4, {0, 0, 0, 1});
    b.add(mesh);
    const auto scene = b.build();
    RayTally tally;
    const auto hit = scene->intersect(Vec3(Vec3d{0.5, 0.4, 1} - scene->centre()), {}, {0, 0, -1},
                                      RayKind::Camera, tally);
    ASSERT_TRUE(hit);
    EXPECT_GT(hit->ns.x, 0.9f);
}

TEST(SurfacePoint, NormalMapsThatSayNothingAreIgnored) {
    SceneBuilder b;
    lacuna::Material below = matte(Rgb(0.5f)), plain = below;
    below.normalTexture = b.add(texelOf(128, 128, 0));
    plain.normalTexture = b.add(texelOf(255, 128, 128));
    b.add(quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add(below)));
    Mesh noTangents = quad({2, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add(plain));
    noTangents.uvs.assign(4, {0.5f, 0.5f});
    b.add(noTangents);
    Mesh noUvs = quad({4, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add(plain));
    noUvs.uvs.clear();
    b.add(noUvs);
    const auto scene = b.build();
    RayTally tally;
    for (const float x : {0.5f, 2.5f, 4.5f}) {
        const auto hit = scene->intersect(Vec3(Vec3d{x, 0.4, 1} - scene->centre()), {}, {0, 0, -1},
                                          RayKind::Camera, tally);
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->ns, hit->ng) << x;
    }
}

struct Met {
    std::unique_ptr<Scene> scene;  // holds what the Bsdf points to
    std::optional<SurfacePoint> point;
    Bsdf bsdf() const { return scene->bsdfAt(point.value()); }
};

/// The point of `mesh` at (0.25, 0.25) that a ray against the z axis hits.
Met meet(SceneBuilder b, Mesh mesh, const lacuna::Material& material) {
    mesh.material = b.add(material);
    b.add(mesh);
    Met met{b.build(), {}};
    RayTally tally;
    met.point = met.scene->intersect(Vec3(Vec3d{0.25, 0.25, 1} - met.scene->centre()), {},
                                     {0, 0, -1}, RayKind::Camera, tally);
    return met;
}

TEST(SurfacePoint, CoatTexturesMultiplyTheirFactors) {
    SceneBuilder b;
    const Texture texel = texelOf(51, 153, 204, 102);  // 0.2, 0.6, 0.8, 0.4
    lacuna::Material textured = plastic({0.5f, 0.4f, 0.3f}, 0);
    textured.specularTexture = textured.specularColorTexture = textured.clearcoatTexture =
        textured.clearcoatRoughnessTexture = b.add(texel);
    textured.specularColor = {2, 1, 3};
    textured.clearcoat = 0.9f;
    textured.clearcoatRoughness = 0.8f;
    lacuna::Material constant = plastic({0.5f, 0.4f, 0.3f}, 0);
    constant.specular = 0.4f;
    constant.specularColor = {0.4f, 0.6f, 2.4f};
    constant.clearcoat = 0.18f;
    constant.clearcoatRoughness = 0.48f;
    const Mesh mesh = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const Met met = meet(b, mesh, textured), other = meet(b, mesh, constant);
    const Bsdf found = met.bsdf(), expected = other.bsdf();
    const Vec3 eye = normalize(Vec3{0.3f, 0.1f, 1}), mirrored{-eye.x, -eye.y, eye.z};
    for (const ScatterEvent event : {ScatterEvent::Smooth, ScatterEvent::DeltaReflection}) {
        const Rgb is = found.evaluate(eye, mirrored, event).f;
        const Rgb should = expected.evaluate(eye, mirrored, event).f;
        EXPECT_GT(should.r, 0);
        EXPECT_NEAR(is.r, should.r, 1e-5 * should.r);
        EXPECT_NEAR(is.g, should.g, 1e-5 * should.g);
        EXPECT_NEAR(is.b, should.b, 1e-5 * should.b);
    }
}

/// A triangle whose texture coordinates grow along x, and along y upwards in the image (against v).
Mesh axesTriangle() {
    Mesh mesh = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.uvs = {{0, 1}, {1, 1}, {0, 0}};
    return mesh;
}

void expectVector(const Vec3& found, const Vec3& expected) {
    EXPECT_NEAR(found.x, expected.x, 5e-3);
    EXPECT_NEAR(found.y, expected.y, 5e-3);
    EXPECT_NEAR(found.z, expected.z, 5e-3);
}

TEST(SurfacePoint, GrainTurnsFromTheTangentToTheBitangent) {
    lacuna::Material brushed = metal(Rgb(0.8f), 0.3f);
    brushed.anisotropy = 0.5f;
    expectVector(meet({}, axesTriangle(), brushed).point->grain, {0.5f, 0, 0});
    brushed.anisotropyRotation = std::numbers::pi_v<float> / 6;
    const Vec3 turned{0.433f, 0.25f, 0};
    expectVector(meet({}, axesTriangle(), brushed).point->grain, turned);
    // The texture's direction, towards the bitangent, comes before the rotation.
    SceneBuilder b;
    brushed.anisotropyTexture = b.add(texelOf(128, 255, 128));
    expectVector(meet(b, axesTriangle(), brushed).point->grain, {-0.125f, 0.217f, 0});
    // Tangents go before texture coordinates. With a sign of -1, their bitangent points the other way.
    Mesh mesh = axesTriangle();
    mesh.normals.assign(3, Vec3{0, 0, 1});
    mesh.tangents.assign(3, {0, 1, 0, -1});
    brushed.anisotropyTexture = {};
    expectVector(meet({}, mesh, brushed).point->grain, {0.25f, 0.433f, 0});
    // Without either, the grain has some direction on the surface.
    const Vec3 any = meet({}, triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), brushed).point->grain;
    EXPECT_NEAR(length(any), 0.5, 1e-5);
    EXPECT_NEAR(any.z, 0, 1e-6);
}

TEST(SurfacePoint, GrainTellsTwoDirectionsApart) {
    lacuna::Material brushed = metal(Rgb(0.8f), 0.3f);
    brushed.anisotropy = 0.8f;
    const Met met = meet({}, axesTriangle(), brushed);
    const Vec3 eye{0, 0, 1};
    const auto towards = [&](Vec3 light) { return met.bsdf().evaluate(eye, normalize(light)).f.g; };
    EXPECT_GT(towards({0.6f, 0, 1}), 10 * towards({0, 0.6f, 1}));
}

TEST(SurfacePoint, LacquerHasTheMeshsNormalsOrItsOwn) {
    SceneBuilder b;
    lacuna::Material lacquer = plastic(Rgb(0.5f), 0.5f);
    lacquer.clearcoat = 1;
    EXPECT_EQ(meet(b, axesTriangle(), lacquer).point->clearcoatNs, Vec3{});
    const TextureUse map = b.add(texelOf(218, 128, 218));  // 45 degrees towards the tangent
    lacquer.normalTexture = map;
    const Met smooth = meet(b, axesTriangle(), lacquer);
    expectVector(smooth.point->clearcoatNs, {0, 0, 1});
    expectVector(smooth.point->ns, {0.707f, 0, 0.707f});
    lacquer.normalTexture = {};
    lacquer.clearcoatNormalTexture = map;
    const Met bumpy = meet(b, axesTriangle(), lacquer);
    expectVector(bumpy.point->clearcoatNs, {0.707f, 0, 0.707f});
    expectVector(bumpy.point->ns, {0, 0, 1});
    // The lacquer mirrors about its own normal.
    const Vec3 eye = normalize(Vec3{0.5f, 0, 1}), mirrored{eye.z, 0, eye.x};
    EXPECT_GT(bumpy.bsdf().evaluate(eye, mirrored, ScatterEvent::DeltaReflection).f.g, 0.0f);
    lacquer.clearcoatNormalScale = 0;
    expectVector(meet(b, axesTriangle(), lacquer).point->clearcoatNs, {0, 0, 1});
}

TEST(SurfacePoint, SheenAndLeafTexturesMultiplyTheirFactors) {
    SceneBuilder b;
    const Texture texel = texelOf(51, 153, 204, 102);  // 0.2, 0.6, 0.8, 0.4
    lacuna::Material textured = plastic({0.5f, 0.4f, 0.3f}, 0.5f);
    textured.sheenColorTexture = textured.sheenRoughnessTexture =
        textured.diffuseTransmissionTexture = textured.diffuseTransmissionColorTexture =
            b.add(texel);
    textured.sheenColor = {0.5f, 1, 0.25f};
    textured.sheenRoughness = 0.9f;
    textured.diffuseTransmission = 0.5f;
    textured.diffuseTransmissionColor = {1, 0.5f, 1};
    lacuna::Material constant = plastic({0.5f, 0.4f, 0.3f}, 0.5f);
    constant.sheenColor = {0.1f, 0.6f, 0.2f};
    constant.sheenRoughness = 0.36f;
    constant.diffuseTransmission = 0.2f;
    constant.diffuseTransmissionColor = {0.2f, 0.3f, 0.8f};
    const Mesh mesh = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const Met met = meet(b, mesh, textured), other = meet(b, mesh, constant);
    const Bsdf found = met.bsdf(), expected = other.bsdf();
    const Vec3 eye = normalize(Vec3{0.9f, 0.1f, 0.4f});
    for (const Vec3& light : {normalize(Vec3{-0.2f, 0.8f, 0.3f}), normalize(Vec3{0.1f, 0, -1})}) {
        const Rgb is = found.evaluate(eye, light).f, should = expected.evaluate(eye, light).f;
        EXPECT_GT(should.r, 0);
        EXPECT_NEAR(is.r, should.r, 2e-4 * should.r);
        EXPECT_NEAR(is.g, should.g, 2e-4 * should.g);
        EXPECT_NEAR(is.b, should.b, 2e-4 * should.b);
    }
}

TEST(SurfacePoint, ColouredPointsAreOfThatColoursMaterial) {
    const Mesh plain = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    Mesh coloured = plain;
    const std::array<float, 4> tint{0.5f, 1.0f, 0.0f, 1.0f};
    coloured.colors.assign(3, tint);
    const Vec3 eye = normalize(Vec3{0.3f, 0.1f, 1}), light = normalize(Vec3{-0.2f, 0.5f, 0.7f});
    for (lacuna::Material material :
         {matte(Rgb(0.9f)), plastic({0.5f, 0.4f, 0.3f}, 0.3f), metal(Rgb(0.8f), 0.4f),
          glass(1.0f, 0.5f), plastic({3.0f, 0.4f, 0.3f}, 0.0f)}) {
        for (const std::uint8_t grey : {std::uint8_t(0), std::uint8_t(255)}) {
            SceneBuilder b;
            lacuna::Material textured = material, constant = material;
            textured.baseColorTexture = b.add(texelOf(grey, grey, grey));
            constant.baseColor *= Rgb(float(grey) / 255) * Rgb(tint[0], tint[1], tint[2]);
            const Met met = meet(b, coloured, textured), other = meet(b, plain, constant);
            const Bsdf found = met.bsdf(), expected = other.bsdf();
            EXPECT_EQ(found.connectable(), expected.connectable());
            EXPECT_EQ(found.isBlack(), expected.isBlack());
            EXPECT_EQ(found.survivalAlbedo(), expected.survivalAlbedo());
            for (const ScatterEvent event : {ScatterEvent::Smooth, ScatterEvent::DeltaReflection}) {
                const BsdfEvaluation is = found.evaluate(eye, light, event);
                const BsdfEvaluation should = expected.evaluate(eye, light, event);
                EXPECT_EQ(is.f, should.f);
                EXPECT_EQ(is.pdfWToEye, should.pdfWToEye);
                EXPECT_EQ(is.pdfWToLight, should.pdfWToLight);
            }
        }
    }
}

TEST(SurfacePoint, TexturesLieByTheSetTheyAskFor) {
    SceneBuilder b;
    Texture halves;  // red with alpha 0, then blue
    halves.width = 2;
    halves.height = 1;
    halves.rgba = {255, 0, 0, 0, 0, 0, 255, 255};
    TextureUse first = b.add(halves), second = first;
    second.secondSet = true;
    Mesh mesh = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.uvs.assign(3, {0.25f, 0.5f});
    mesh.uvs1.assign(3, {0.75f, 0.5f});
    lacuna::Material material = matte(Rgb(1.0f));
    material.baseColorTexture = first;
    EXPECT_EQ(meet(b, mesh, material).bsdf().layerAlbedo(), Rgb(1, 0, 0));
    material.baseColorTexture = second;
    material.emission = Rgb(1.0f);
    material.emissiveTexture = second;
    material.alphaMode = lacuna::Material::Alpha::Mask;
    const Met met = meet(b, mesh, material);
    ASSERT_TRUE(met.point);  // where the first set has no surface
    EXPECT_EQ(met.bsdf().layerAlbedo(), Rgb(0, 0, 1));
    Rng rng(1, 0, StreamKind::LightPath, 0);
    const Rgb exitance = met.scene->lights().samplePoint(rng).exitance;
    EXPECT_GT(exitance.b, 1.0f);
    EXPECT_LT(exitance.r, 1e-5f);
    // A set that the mesh lacks is (0, 0) everywhere, which is between both halves.
    mesh.uvs1.clear();
    material.alphaMode = lacuna::Material::Alpha::Opaque;
    const Rgb corner = meet(b, mesh, material).bsdf().layerAlbedo();
    EXPECT_NEAR(corner.r, 0.5, 1e-5);
    EXPECT_NEAR(corner.b, 0.5, 1e-5);
}

TEST(SurfacePoint, ASecondSetTurnsNormalMaps) {
    SceneBuilder b;
    lacuna::Material material = matte(Rgb(0.5f));
    material.normalTexture = b.add(texelOf(255, 128, 128));  // towards growing u
    material.normalTexture.secondSet = true;
    Mesh mesh = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.uvs1 = {{0, 0}, {0, 1}, {1, 0}};  // u along y
    const Met met = meet(b, mesh, material);
    ASSERT_TRUE(met.point);
    EXPECT_GT(met.point->ns.y, 0.9f);
}

TEST(SurfacePoint, VertexColoursAreInterpolatedAndMultiply) {
    SceneBuilder b;
    Mesh mesh = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.add(matte({0.5f, 1.0f, 1.0f})));
    mesh.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
    b.add(mesh);
    const auto scene = b.build();
    RayTally tally;
    const auto hit = scene->intersect(Vec3(Vec3d{0.2, 0.3, 1} - scene->centre()), {}, {0, 0, -1},
                                      RayKind::Camera, tally);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->color.r, 0.5, 1e-5);
    EXPECT_NEAR(hit->color.g, 0.2, 1e-5);
    EXPECT_NEAR(hit->color.b, 0.3, 1e-5);
    const Rgb albedo = scene->bsdfAt(*hit).layerAlbedo();
    EXPECT_NEAR(albedo.r, 0.25, 1e-5);
    EXPECT_NEAR(albedo.g, 0.2, 1e-5);
    EXPECT_NEAR(albedo.b, 0.3, 1e-5);
}

}  // namespace
}  // namespace lacuna::test
