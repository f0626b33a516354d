// A scene as a whole: its content, its position, and what remains of it if parts are missing.
#include "libcore/scene/scene.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "libcore/base/error.h"
#include "libcore/image/image_io.h"
#include "tests/scene/sphere_bins.h"
#include "tests/scene/surface_points.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

/// A picture in a file that is removed after the test.
class TemporaryPfm {
  public:
    explicit TemporaryPfm(const Image& image)
        : path_((std::filesystem::temp_directory_path() /
                 ("lacuna-scene-" + std::to_string(getpid()) + ".pfm"))
                    .string()) {
        writePfm(path_, image);
    }
    ~TemporaryPfm() { std::filesystem::remove(path_); }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
};

TEST(Scene, MovedAndScaledGivesTheSameHits) {
    const auto build = [](const Affine& m) {
        SceneBuilder b;
        const std::uint32_t glow = b.add(emitter(Rgb(3.0f)));
        b.add(box({-2, -2, -2}, {2, 2, 2}, 0, true), m);
        const std::uint32_t lamp = b.add(box({-0.3f, -0.2f, -0.1f}, {0.3f, 0.2f, 0.1f}, glow),
                                         m * translation({0.5, 1, 0.2}) * rotation({1, 1, 0}, 30));
        b.instance(lamp,
                   m * translation({-1, -1, 0.5}) * rotation({0, 1, 3}, 70) * scaling({1, -2, 1}));
        b.add(pointLight(m.point({1, 1, 1}), Rgb(1.0f)));
        CameraDescription c = lookAt({1.5, 1.5, 1.5}, {0, 0, 0}, 50);
        c.toWorld = m * c.toWorld;
        b.add(c);
        return b.build();
    };
    const auto base = build({});
    int most = 0;
    for (const double scale : {1e-3, 1.0, 1e3}) {
        for (const double offset : {0.0, 1e5, -1e5}) {
            SCOPED_TRACE(std::to_string(scale) + " at " + std::to_string(offset));
            const auto scene = build(translation({offset, -offset, 0.5 * offset}) *
                                     scaling({scale, scale, scale}));
            EXPECT_NEAR(scene->radius() / scale / base->radius(), 1, 1e-6);
            const Camera::Film film{64, 48};
            const Camera camera = scene->makeCamera("", film, {});
            EXPECT_LT(length(camera.position() * float(1 / scale) -
                             base->makeCamera("", film, {}).position()),
                      1e-5f);
            Rng lightA(2, 0, StreamKind::User, 0), lightB = lightA;
            RayTally tally;
            Rng rng(1, 0, StreamKind::User, 0);
            int different = 0;
            for (int i = 0; i < 1000; ++i) {
                const Vec3 d = randomDirection(rng), from = randomDirection(rng);
                const auto p = base->intersect(from, {}, d, RayKind::Camera, tally);
                const auto q = scene->intersect(from * float(scale), {}, d, RayKind::Camera, tally);
                ASSERT_TRUE(p && q);
                if (p->light != q->light || length(p->ng - q->ng) > 0.1f) {
                    ++different;  // at an edge
                    continue;
                }
                // At an offset of 1e5, file coordinates in double are exact to 1e-11 / scale.
                const float slack = 1e-5f / std::abs(dot(p->ng, d));
                ASSERT_LT(length(q->position * float(1 / scale) - p->position), slack);
                ASSERT_LT(length(q->ng - p->ng), 1e-5f);
                const LightPoint a = base->lights().samplePoint(lightA),
                                 b = scene->lights().samplePoint(lightB);
                // Their powers scale differently, so only picks of the same kind are compared.
                if (a.kind == b.kind && a.light == b.light && a.kind == LightKind::Area) {
                    ASSERT_LT(length(b.ng - a.ng), 1e-5f);
                }
            }
            EXPECT_LE(different, 4);
            most = std::max(most, different);
        }
    }
    stabilityCase("offset", most, "of 1000 rays hit something else, at an edge");
}

TEST(Scene, Empty) {
    const auto scene = SceneBuilder().build();
    RayTally tally;
    EXPECT_EQ(scene->radius(), 0.0f);
    EXPECT_EQ(scene->triangleCount(), 0u);
    EXPECT_TRUE(scene->lights().empty());
    EXPECT_EQ(scene->lights().size(), 0u);
    EXPECT_EQ(scene->environment(), nullptr);
    EXPECT_FALSE(scene->intersect({}, {}, {0, 0, 1}, RayKind::Camera, tally));
    EXPECT_TRUE(scene->visible({0, 0, 0}, {}, {1, 0, 0}, {}, RayKind::Connection, tally));
    EXPECT_TRUE(scene->visibleToInfinity({}, {}, {1, 0, 0}, RayKind::Connection, tally));
    EXPECT_EQ(tally.counts[std::size_t(RayKind::Camera)], 1u);
    EXPECT_EQ(tally.counts[std::size_t(RayKind::Connection)], 2u);
}

TEST(Scene, OnlyAnEnvironment) {
    const TemporaryPfm file(Image(8, 4, Rgb(2.0f)));
    SceneBuilder b;
    b.environment(file.path(), 1.5, 45);
    const auto scene = b.build();
    ASSERT_TRUE(scene->environment());
    EXPECT_NEAR(scene->environment()->radiance({0, 1, 0}).g, 3.0f, 1e-6f);
    const Lights& lights = scene->lights();
    ASSERT_FALSE(lights.empty());
    EXPECT_EQ(lights.pmf(lights.environmentIndex()), 1.0);
    Rng rng(1, 0, StreamKind::User, 0);
    const LightPoint p = lights.samplePoint(rng);
    const auto ray = lights.sampleEmission(p, rng);
    ASSERT_TRUE(ray);
    EXPECT_TRUE(isFinite(ray->origin) && ray->emission.pdfW > 0 && p.pdf > 0);
    EXPECT_TRUE(std::isfinite(ray->emission.pdfW));
    RayTally tally;
    EXPECT_FALSE(scene->intersect(ray->origin, {}, ray->direction, RayKind::LightWalk, tally));
}

TEST(Scene, MissingEnvironmentIsAnError) {
    SceneBuilder b;
    b.environment("/nowhere/sky.exr");
    EXPECT_THROW(b.build(), InputError);
}

TEST(Scene, MeshesWithoutTriangles) {
    SceneBuilder b;
    const std::uint32_t glow = b.add(emitter(Rgb(1.0f)));
    Mesh none;
    none.material = glow;
    Mesh points = none, flat = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, glow);
    points.positions = {{0, 0, 0}, {1, 1, 1}};
    flat.triangles = {{0, 0, 1}, {2, 2, 2}};
    b.add(none);
    const std::uint32_t twice = b.add(points);
    b.instance(twice, translation({1, 0, 0}));
    b.add(flat);
    b.d.meshes.push_back(quad({5, 5, 5}, {1, 0, 0}, {0, 1, 0}));  // used by no instance
    const std::uint32_t last = b.add(quad({0, 0, -1}, {1, 0, 0}, {0, 1, 0}, glow));
    EXPECT_EQ(last, 4u);
    const auto scene = b.build();
    EXPECT_EQ(scene->triangleCount(), 2u);
    ASSERT_EQ(scene->lights().size(), 2u);
    RayTally tally;
    const Vec3 from(Vec3d{0.7, 0.2, 3} - scene->centre());
    const auto hit = scene->intersect(from, {}, {0, 0, -1}, RayKind::Camera, tally);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->material, glow);
    EXPECT_EQ(hit->light, 0u);
}

TEST(Scene, VerticesThatOverflowAreRefused) {
    SceneBuilder b;
    b.add(quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    const float huge = std::numeric_limits<float>::max();
    Mesh m = triangle({0, 0, 0}, {huge, 0, 0}, {0, huge, 0});
    b.add(m, scaling({10, 10, 10}));
    EXPECT_THROW(b.build(), InputError);
}

TEST(Scene, LightsKeepTheirOrder) {
    SceneBuilder b;
    const std::uint32_t glow = b.add(emitter(Rgb(1.0f)));
    b.add(quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    b.add(quad({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, glow));
    b.add(pointLight({2, 2, 2}, Rgb(1.0f)));
    b.add(directionalLight({0, -1, 0}, Rgb(1.0f)));
    const auto scene = b.build();
    const Lights& lights = scene->lights();
    ASSERT_EQ(lights.size(), 4u);
    EXPECT_EQ(lights.kind(0), LightKind::Area);
    EXPECT_EQ(lights.kind(1), LightKind::Area);
    EXPECT_EQ(lights.kind(2), LightKind::Point);
    EXPECT_EQ(lights.kind(3), LightKind::Directional);
    EXPECT_EQ(lights.environmentIndex(), kNone);
}

TEST(Scene, Cameras) {
    SceneBuilder b;
    b.d.file = "door.glb";
    EXPECT_THROW(b.build()->makeCamera("", {4, 4}, {}), InputError);
    CameraDescription first = lookAt({0, 0, 5}, {0, 0, 0}, 40);
    CameraDescription second = lookAt({5, 0, 0}, {0, 0, 0}, 40);
    second.name = "side";
    b.add(first);
    b.add(second);
    const auto scene = b.build();
    EXPECT_LT(length(scene->makeCamera("", {4, 4}, {}).forward() - Vec3{0, 0, -1}), 1e-6f);
    EXPECT_LT(length(scene->makeCamera("side", {4, 4}, {}).forward() - Vec3{-1, 0, 0}), 1e-6f);
    try {
        scene->makeCamera("top", {4, 4}, {});
        FAIL();
    } catch (const UsageError& e) {
        EXPECT_NE(std::string(e.what()).find("'camera', 'side'"), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace lacuna::test
