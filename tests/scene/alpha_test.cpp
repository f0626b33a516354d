// Alpha: MASK lets rays pass exactly where alpha < cutoff, BLEND lets a share of them pass. This
// holds for closest hits and shadow rays alike.
#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/rng.h"
#include "libcore/scene/texture.h"
#include "tests/scene/surface_points.h"

namespace lacuna::test {
namespace {

Texture leaf() {
    Texture t;
    t.width = t.height = 8;
    Rng rng(1, 0, StreamKind::User, 0);
    for (int i = 0; i < 64; ++i) {
        const std::uint8_t texel[] = {255, 255, 255, std::uint8_t(rng.below(256))};
        t.rgba.insert(t.rgba.end(), texel, texel + 4);
    }
    return t;
}

TEST(AlphaMask, HolesInHitsAndShadows) {
    for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
        for (const double mirror : {1.0, -1.0}) {
            SceneBuilder b;
            lacuna::Material m = matte(Rgb(0.5f));
            m.alphaMode = lacuna::Material::Alpha::Mask;
            m.alphaCutoff = 0.4f;
            m.baseAlpha = 0.9f;
            m.baseColorTexture = b.add(leaf());
            const Affine turned = rotation({1, 2, 3}, 40) * scaling({mirror, 1, 1});
            place(b, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add(m)), turned, placement);
            // A solid wall behind it.
            b.add(quad({-5, -5, -1}, {10, 0, 0}, {0, 10, 0}), rotation({1, 2, 3}, 40));
            const auto scene = b.build();
            RayTally tally;
            Rng rng(2, 0, StreamKind::User, 0);
            int holes = 0, solid = 0;
            for (int i = 0; i < 3000; ++i) {
                const Vec2 uv{rng.uniform(), rng.uniform()};
                const float alpha = 0.9f * sampleTexture(b.d.textures[0], uv).alpha;
                if (std::abs(alpha - 0.4f) < 1e-3f) continue;
                const Vec3d local{2.0 * uv.x - 1, 2.0 * uv.y - 1, 0};
                const Vec3d at = turned.point(local) - scene->centre();
                const Vec3d n = turned.vector({0, 0, 1});
                const Vec3 from(at + n * 0.7), to(at - n * 0.6);
                const auto hit = scene->intersect(from, {}, Vec3(-n), RayKind::Camera, tally);
                ASSERT_TRUE(hit);
                const bool there = length(Vec3d(hit->position) - at) < 1e-3;
                ASSERT_EQ(there, alpha > 0.4f) << uv.x << " " << uv.y;
                ASSERT_EQ(hit->material, there ? 1u : 0u);
                ASSERT_EQ(scene->visible(from, {}, to, {}, RayKind::Connection, tally), !there);
                ASSERT_EQ(scene->visibleToInfinity(to, {}, Vec3(n), RayKind::Connection, tally),
                          !there);
                ++(there ? solid : holes);
            }
            EXPECT_GT(holes, 800);
            EXPECT_GT(solid, 800);
        }
    }
}

TEST(AlphaMask, CutoffItselfIsThere) {
    // glTF: rendered as fully opaque where alpha >= cutoff.
    for (const auto& [alpha, cutoff, there] : {std::tuple{0.5f, 0.5f, true},
                                               {0.499f, 0.5f, false},
                                               {0.0f, 0.0f, true},
                                               {1.0f, 1.01f, false}}) {
        SceneBuilder b;
        lacuna::Material m = matte(Rgb(0.5f));
        m.alphaMode = lacuna::Material::Alpha::Mask;
        m.baseAlpha = alpha;
        m.alphaCutoff = cutoff;
        b.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add(m)));
        const auto scene = b.build();
        RayTally tally;
        EXPECT_EQ(
            scene->intersect({0.1f, 0.2f, 1}, {}, {0, 0, -1}, RayKind::Camera, tally).has_value(),
            there);
    }
}

TEST(AlphaBlend, AShareOfTheRaysPasses) {
    // Factor, texture and vertex colour multiply: 0.8 x 0.75 x 0.5 = 0.3.
    constexpr double kAlpha = 0.8 * (191.0 / 255.0) * 0.5;
    constexpr int kRays = 40000;
    for (const Placement placement : {Placement::Baked, Placement::Instanced}) {
        SceneBuilder b;
        lacuna::Material m = matte(Rgb(0.5f));
        m.alphaMode = lacuna::Material::Alpha::Blend;
        m.baseAlpha = 0.8f;
        Texture t;
        t.width = t.height = 1;
        t.rgba = {255, 255, 255, 191};
        m.baseColorTexture = b.add(t);
        Mesh veil = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add(m));
        veil.colors.assign(4, {1, 1, 1, 0.5f});
        place(b, veil, {}, placement);
        b.add(quad({-5, -5, -1}, {10, 0, 0}, {0, 10, 0}));
        const auto scene = b.build();
        const Vec3 centre(scene->centre());
        RayTally tally;
        Rng rng(3, 0, StreamKind::User, 0);
        int hits = 0, shadows = 0, both = 0;
        for (int i = 0; i < kRays; ++i) {
            const Vec3 from =
                Vec3{1.8f * rng.uniform() - 0.9f, 1.8f * rng.uniform() - 0.9f, 1} - centre;
            const Vec3 to = from - Vec3{0, 0, 1.5f};
            const auto hit = scene->intersect(from, {}, {0, 0, -1}, RayKind::Camera, tally);
            ASSERT_TRUE(hit);
            const bool met = hit->material == 1;
            const bool shadow = !scene->visible(from, {}, to, {}, RayKind::Connection, tally);
            const auto again = scene->intersect(from, {}, {0, 0, -1}, RayKind::Camera, tally);
            ASSERT_EQ(again->material, hit->material);
            hits += met;
            shadows += shadow;
            both += met && shadow;
        }
        // Five standard deviations: 6e-7 false alarms each. Two different rays along one line
        // decide independently.
        const double sigma = std::sqrt(kAlpha * (1 - kAlpha) / kRays);
        EXPECT_NEAR(double(hits) / kRays, kAlpha, 5 * sigma);
        EXPECT_NEAR(double(shadows) / kRays, kAlpha, 5 * sigma);
        EXPECT_NEAR(double(both) / kRays, kAlpha * kAlpha, 5 * sigma);
    }
}

TEST(AlphaBlend, OpaqueTexelsLeaveNoHoles) {
    SceneBuilder b;
    lacuna::Material m = matte(Rgb(0.5f));
    m.alphaMode = lacuna::Material::Alpha::Blend;
    b.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add(m)));
    EXPECT_EQ(b.build()->blockingTriangles(pool()).size(), 2u);
    b.d.materials.back().baseAlpha = 0.4f;
    EXPECT_TRUE(b.build()->blockingTriangles(pool()).empty());
    b.d.materials.back().baseAlpha = 0.6f;
    EXPECT_EQ(b.build()->blockingTriangles(pool()).size(), 2u);
}

TEST(AlphaMask, OpaqueIgnoresAlpha) {
    SceneBuilder b;
    lacuna::Material m = matte(Rgb(0.5f));
    m.baseAlpha = 0;
    b.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add(m)));
    const auto scene = b.build();
    RayTally tally;
    EXPECT_TRUE(scene->intersect({0.1f, 0.2f, 1}, {}, {0, 0, -1}, RayKind::Camera, tally));
}

}  // namespace
}  // namespace lacuna::test
