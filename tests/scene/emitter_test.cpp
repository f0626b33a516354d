// Area lights of a scene. Sides, barycentrics and densities must be the same where light paths
// start and where eye paths end, under every transform, baked and instanced (numerics.md,
// "Lights").
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcore/base/error.h"
#include "libcore/scene/texture.h"
#include "tests/scene/sphere_bins.h"
#include "tests/scene/surface_points.h"

namespace lacuna::test {
namespace {

Texture gradient() {
    Texture t;
    t.width = t.height = 8;
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
            const std::uint8_t texel[] = {std::uint8_t(30 * x + 10), std::uint8_t(30 * y + 10),
                                          std::uint8_t(200 - 10 * x - 10 * y), 255};
            t.rgba.insert(t.rgba.end(), texel, texel + 4);
        }
    }
    return t;
}

/// Two copies of a glowing, textured box under `toWorld`.
SceneBuilder glowingBox(const Affine& toWorld, Placement placement, bool twoSided) {
    SceneBuilder b;
    lacuna::Material m = emitter({5, 4, 3}, twoSided);
    m.emissiveTexture = b.add(gradient());
    const std::uint32_t material = b.add(m);
    place(b, box({-0.5f, -0.4f, -0.3f}, {0.5f, 0.4f, 0.3f}, material), toWorld, placement);
    return b;
}

TEST(AreaLights, LightAndEyePathsAgree) {
    for (const NamedTransform& t : transforms()) {
        if (t.name == "tiny" || t.name == "nearly flat") continue;  // too small against the scene
        for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
            SCOPED_TRACE(t.name + (placement == Placement::Baked ? ", baked" : ", instanced"));
            const SceneBuilder b = glowingBox(t.toWorld, placement, false);
            const auto scene = b.build();
            const Lights& lights = scene->lights();
            ASSERT_EQ(lights.size(), 24u);
            RayTally tally;
            int asked = 0;
            for (unsigned i = 0; i < 500; ++i) {
                Rng rng(1, 0, StreamKind::User, i);
                const LightPoint y = lights.samplePoint(rng);
                const auto& k = y.uv;
                if (std::min({k.x, k.y, 1 - k.x - k.y}) < 0.02f) continue;  // too near an edge
                ++asked;
                // The mesh's front faces outwards, and so does its image under every transform.
                const Vec3d middle = t.toWorld.m[3] - scene->centre();
                const Vec3d other = middle + Vec3d{0, -20, 0};
                const Vec3d p(y.position);
                const Vec3d own = length(p - middle) < length(p - other) ? middle : other;
                ASSERT_GT(dot(Vec3d(y.ng), p - own), 0) << "emits inwards";

                // An eye path from the emitting side.
                const Vec3 away = normalize(y.ng + randomDirection(rng) * 0.5f);
                const auto hit =
                    scene->intersect(y.position + away * 0.2f, {}, -away, RayKind::EyeWalk, tally);
                ASSERT_TRUE(hit);
                ASSERT_EQ(hit->light, y.light);
                const float slack = 1e-5f / dot(y.ng, away);
                ASSERT_LT(length(hit->position - y.position), slack);
                ASSERT_LT(length(hit->ng - y.ng), 1e-5f);
                ASSERT_NEAR(hit->barycentric.x, y.uv.x, 20 * slack);
                ASSERT_NEAR(hit->barycentric.y, y.uv.y, 20 * slack);
                const LightPoint z =
                    lights.areaPoint(hit->light, hit->position, hit->ng, hit->barycentric);
                ASSERT_EQ(z.pdf, y.pdf);
                ASSERT_NEAR(z.exitance.r, y.exitance.r, 2e-3f * y.exitance.r);
                ASSERT_NEAR(z.exitance.b, y.exitance.b, 2e-3f * y.exitance.b);
                // The exitance is the texture at the surface's coordinates.
                const Rgb texel = sampleTexture(b.d.textures[0], hit->uv).rgb;
                ASSERT_NEAR(z.exitance.r, texel.r * 5 * kPi, 1e-4f * z.exitance.r);
                ASSERT_NEAR(z.exitance.g, texel.g * 4 * kPi, 1e-4f * z.exitance.g);
                // The back is dark.
                ASSERT_EQ(lights.emission(z, -away, {}).pdfW, 0.0f);
                ASSERT_GT(lights.emission(z, away, {}).pdfW, 0.0f);
                const auto back =
                    scene->intersect(y.position - y.ng * 0.01f, {}, y.ng, RayKind::EyeWalk, tally);
                ASSERT_TRUE(back);
                ASSERT_LT(length(back->ng - y.ng), 1e-5f) << "the normal does not follow the ray";
            }
            EXPECT_GT(asked, 350);
        }
    }
}

/// The mean opacity of a lamp's points is the share that rays find, under every transform.
TEST(AreaLights, PointsAreThereAsOftenAsRaysFindThem) {
    using Alpha = lacuna::Material::Alpha;
    for (const NamedTransform& t : transforms()) {
        if (t.name == "tiny" || t.name == "nearly flat") continue;  // too small against the scene
        for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
            for (const Alpha mode : {Alpha::Mask, Alpha::Blend}) {
                SCOPED_TRACE(t.name + (placement == Placement::Baked ? ", baked" : ", instanced"));
                SceneBuilder b;
                lacuna::Material m = emitter({5, 4, 3});
                m.alphaMode = mode;
                m.baseAlpha = 0.9f;
                m.baseColorTexture = b.add(gradient());
                for (std::size_t i = 0; i < b.d.textures[0].rgba.size(); i += 4) {
                    b.d.textures[0].rgba[i + 3] = b.d.textures[0].rgba[i];
                }
                Mesh sheet = quad({-0.5f, -0.4f, 0}, {1, 0, 0}, {0, 0.8f, 0.1f}, b.add(m));
                sheet.colors = {{1, 1, 1, 0.6f}, {1, 1, 1, 1}, {1, 1, 1, 0.8f}, {1, 1, 1, 1}};
                place(b, sheet, t.toWorld, placement);
                const auto scene = b.build();
                const Lights& lights = scene->lights();
                RayTally tally;
                double expected = 0, found = 0;
                int asked = 0;
                for (unsigned i = 0; i < 2000; ++i) {
                    Rng rng(9, 0, StreamKind::User, i);
                    const LightPoint y = lights.samplePoint(rng);
                    const auto& k = y.uv;
                    if (std::min({k.x, k.y, 1 - k.x - k.y}) < 0.02f) continue;
                    ASSERT_TRUE(mode == Alpha::Blend || y.opacity == 0.0f || y.opacity == 1.0f);
                    const Vec3 away = normalize(y.ng + randomDirection(rng) * 0.3f);
                    const auto hit = scene->intersect(y.position + away * 0.2f, {}, -away,
                                                      RayKind::EyeWalk, tally);
                    const bool there =
                        hit && length(hit->position - y.position) < 1e-5f / dot(y.ng, away);
                    ++asked;
                    expected += double(y.opacity);
                    found += there;
                    if (!there) continue;
                    const LightPoint z =
                        lights.areaPoint(hit->light, hit->position, hit->ng, hit->barycentric);
                    ASSERT_EQ(z.pdf, y.pdf);
                    ASSERT_NEAR(z.opacity, y.opacity, 2e-3f);
                    ASSERT_EQ(z.opacity, lights.opacity(hit->light, hit->barycentric));
                }
                // Five standard deviations of so many draws, 6e-7 false alarms each. A mask's edge
                // may fall between the drawn and the hit point.
                const double slack = mode == Alpha::Mask ? 3 : 5 * std::sqrt(0.25 * asked);
                EXPECT_NEAR(found, expected, slack);
                EXPECT_GT(expected, 0.1 * asked);
                EXPECT_LT(expected, 0.9 * asked);
            }
        }
    }
}

TEST(AreaLights, SidesFollowTheWindingAndTheDeterminant) {
    // One triangle, counter-clockwise about +z, under every sign of scale.
    for (int signs = 0; signs < 8; ++signs) {
        const Vec3d s{signs & 1 ? -1.0 : 1.0, signs & 2 ? -2.0 : 2.0, signs & 4 ? -3.0 : 3.0};
        for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
            SceneBuilder b;
            const std::uint32_t glow = b.add(emitter(Rgb(1.0f)));
            Mesh m = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, glow);
            m.normals = {{0, 0, -1}, {0, 0, -1}, {0, 0, -1}};  // wrong on purpose: ignored
            place(b, m, scaling(s), placement);
            const auto scene = b.build();
            Rng rng(2, 0, StreamKind::User, 0);
            const LightPoint y = scene->lights().samplePoint(rng);
            // A mirroring transform reverses the order of corners, but the front still follows the
            // mesh's +z.
            EXPECT_LT(length(y.ng - Vec3{0, 0, s.z > 0 ? 1.0f : -1.0f}), 1e-6f) << signs;
            RayTally tally;
            const auto hit = scene->intersect(y.position + Vec3{0, 0, 1}, {}, {0, 0, -1},
                                              RayKind::EyeWalk, tally);
            ASSERT_TRUE(hit);
            EXPECT_EQ(hit->ng, y.ng) << signs;
            EXPECT_EQ(hit->ns, y.ng) << signs;
        }
    }
}

TEST(AreaLights, DoubleSidedEmitsBothWaysTheSame) {
    const auto scene = glowingBox(scaling({1, 1, -1}), Placement::Instanced, true).build();
    for (unsigned i = 0; i < 200; ++i) {
        Rng rng(3, 0, StreamKind::User, i);
        const LightPoint y = scene->lights().samplePoint(rng);
        const Vec3 d = randomDirection(rng);
        const auto front = scene->lights().emission(y, d, {}),
                   back = scene->lights().emission(y, -d, {});
        EXPECT_EQ(front.pdfW, back.pdfW);
        EXPECT_EQ(front.profile, back.profile);
        EXPECT_GT(front.pdfW, 0.0f);
    }
}

TEST(AreaLights, DegenerateTrianglesAreNoLights) {
    for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
        SceneBuilder b;
        const std::uint32_t glow = b.add(emitter(Rgb(2.0f)));
        Mesh m = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, glow);
        m.positions.push_back(m.positions[2]);  // a duplicate: index 4
        m.uvs.push_back(m.uvs[2]);
        m.triangles = {{0, 0, 1}, {0, 1, 2}, {2, 4, 3}, {1, 1, 1}, {0, 2, 3}};
        place(b, m, {}, placement);
        const auto scene = b.build();
        EXPECT_EQ(scene->triangleCount(), 4u);
        ASSERT_EQ(scene->lights().size(), 4u);
        RayTally tally;
        for (unsigned i = 0; i < 200; ++i) {
            Rng rng(4, 0, StreamKind::User, i);
            const LightPoint y = scene->lights().samplePoint(rng);
            EXPECT_NEAR(y.pdf, 0.5, 1e-5);  // four halves of a unit square
            const auto hit =
                scene->intersect(y.position + y.ng * 0.5f, {}, -y.ng, RayKind::EyeWalk, tally);
            ASSERT_TRUE(hit);
            if (std::abs(y.uv.x) < 0.01f || std::abs(y.uv.y) < 0.01f) continue;
            EXPECT_EQ(hit->light, y.light);
            EXPECT_NEAR(hit->barycentric.x, y.uv.x, 1e-3f);
        }
    }
}

TEST(AreaLights, DiskOfLightsAtInfinityCoversTheScene) {
    // radius() must include all geometry, baked or instanced.
    Rng rng(5, 0, StreamKind::User, 0);
    for (const NamedTransform& t : transforms()) {
        for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
            const auto scene = glowingBox(t.toWorld, placement, false).build();
            const Mesh m = box({-0.5f, -0.4f, -0.3f}, {0.5f, 0.4f, 0.3f});
            EXPECT_GE(scene->lights().diskRadius(), scene->radius());
            for (const Vec3& p : m.positions) {
                for (const double y : {0.0, -20.0}) {
                    const Vec3d w = t.toWorld.point(Vec3d(p)) + Vec3d{0, y, 0} - scene->centre();
                    EXPECT_LE(length(w), scene->radius() * (1 + 1e-6));
                }
            }
        }
    }
}

}  // namespace
}  // namespace lacuna::test
