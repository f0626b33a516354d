// Rays from the camera, and their projection back onto the film (numerics.md, "Camera").
#include "libcore/scene/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/material/statistics.h"
#include "tests/scene/scene_builder.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

struct View {
    const char* name;
    CameraDescription description;
    Vec3d offset;
    Camera::Film film;
};

CameraDescription shifted(CameraDescription camera, std::array<double, 2> shift) {
    camera.shift = shift;
    return camera;
}

std::vector<View> views() {
    const CameraDescription plain = lookAt({0, 0, 0}, {0, 0, -1}, 45);
    const Vec3d far{1e5, 1e5, -1e5};
    CameraDescription scaled =
        lookAt(far + Vec3d{3, -2, 7}, far + Vec3d{-5, 1, 2}, 60, {0.1, 1, 0.2});
    scaled.toWorld = scaled.toWorld * scaling({0.01, 0.01, 0.01});
    CameraDescription uneven = lookAt({3, -2, 7}, {-5, 1, 2}, 30);
    uneven.toWorld = uneven.toWorld * scaling({2, 3, 0.5});
    return {{"plain", plain, {}, {640, 480}},
            {"wide", lookAt({1, 2, 3}, {0, 0, 0}, 120), {}, {1920, 1080}},
            {"tele, upright", lookAt({1, 2, 3}, {0, 0, 0}, 2), {}, {101, 997}},
            {"scaled node, far away", scaled, far, {3840, 2160}},
            {"uneven scale", uneven, {1, 1, 1}, {333, 222}},
            {"one pixel", plain, {}, {1, 1}},
            {"strip", plain, {}, {200, 3}},
            {"shifted", shifted(plain, {0.3, -0.7}), {}, {640, 480}},
            {"shifted, upright", shifted(plain, {-1.5, 0.2}), {}, {101, 499}}};
}

/// The camera in double, from the definition.
struct Exact {
    Vec3d position, right, up, forward;
    double tanX, tanY;
    double left, low;  // of the picture's middle on the image plane
    Camera::Film film;

    explicit Exact(const View& v) : film(v.film) {
        const Affine& m = v.description.toWorld;
        position = m.m[3] - v.offset;
        forward = normalize(-m.m[2]);
        right = normalize(m.m[0]);  // no shear in these tests: the columns are orthogonal
        up = normalize(m.m[1]);
        tanY = std::tan(v.description.yfov / 2);
        tanX = tanY * film.width / film.height;
        const double side = 2 * tanY * std::max(film.width, film.height) / film.height;
        left = v.description.shift[0] * side;
        low = v.description.shift[1] * side;
    }
    Vec3d onImagePlane(double x, double y) const {
        return forward + right * ((2 * x / film.width - 1) * tanX + left) +
               up * ((1 - 2 * y / film.height) * tanY + low);
    }
    /// Raster position of a point (relative to the pinhole).
    Vec3d rasterOf(Vec3d p) const {
        const double z = dot(p, forward);
        return {((dot(p, right) / z - left) / tanX + 1) / 2 * film.width,
                (1 - (dot(p, up) / z - low) / tanY) / 2 * film.height, z};
    }
};

TEST(Camera, RoundTrip) {
    Random random(1);
    double worst = 0;
    for (const View& v : views()) {
        SCOPED_TRACE(v.name);
        // If a pixel subtends less than 2e-4, the rounding of a unit direction is larger than 1e-3
        // pixels.
        const double pixelAngle = 2 * std::tan(v.description.yfov / 2) / v.film.height;
        const double tolerance = std::max(1e-3, 2e-7 / pixelAngle);
        for (const float radius : {0.0f, 0.05f}) {
            const Camera camera(v.description, v.offset, v.film, {radius, 3.0f});
            for (int i = 0; i < 5000; ++i) {
                const Vec2 raster{random.next() * float(v.film.width),
                                  random.next() * float(v.film.height)};
                // At the border within rounding, either answer is right.
                if (raster.x < 1e-3f || raster.y < 1e-3f ||
                    raster.x > float(v.film.width) - 1e-3f ||
                    raster.y > float(v.film.height) - 1e-3f) {
                    continue;
                }
                const Vec3 lens = camera.sampleLens({random.next(), random.next()});
                const Camera::Direction d = camera.directionAt(lens, raster);
                ASSERT_NEAR(length(Vec3d(d.direction)), 1.0, 3e-7);
                const auto p = camera.project(lens, d.direction);
                ASSERT_TRUE(p) << raster.x << " " << raster.y;
                ASSERT_NEAR(p->raster.x, raster.x, tolerance);
                ASSERT_NEAR(p->raster.y, raster.y, tolerance);
                const Vec2 off{p->raster.x - raster.x, p->raster.y - raster.y};
                worst =
                    std::max({worst, std::fabs(off.x) / tolerance, std::fabs(off.y) / tolerance});
                ASSERT_NEAR(p->pdfW / d.pdfW, 1.0f, 1e-5f);
            }
        }
    }
    stabilityCase("film-round-trip", worst, "of the tolerance");
}

TEST(Camera, PinholeDirectionsAgainstTheDefinition) {
    Random random(2);
    for (const View& v : views()) {
        SCOPED_TRACE(v.name);
        const Camera camera(v.description, v.offset, v.film, {});
        const Exact exact(v);
        EXPECT_LT(length(Vec3d(camera.position()) - exact.position),
                  1e-6 * (1 + length(exact.position)));
        EXPECT_LT(length(Vec3d(camera.forward()) - exact.forward), 1e-6);
        for (int i = 0; i < 500; ++i) {
            const double x = random.real() * v.film.width, y = random.real() * v.film.height;
            const Camera::Direction d = camera.directionAt(camera.position(), {float(x), float(y)});
            const Vec3d e = normalize(exact.onImagePlane(float(x), float(y)));
            ASSERT_LT(length(Vec3d(d.direction) - e), 2e-6);
            // Density per pixel: the image plane's area over cos^3.
            const double pixel = 4 * exact.tanX * exact.tanY / (v.film.width * v.film.height);
            ASSERT_NEAR(d.pdfW * pixel * std::pow(dot(e, exact.forward), 3), 1, 1e-5);
        }
        // Up is towards row 0, right towards the last column.
        const Vec3 top =
            camera.directionAt(camera.position(), {float(v.film.width) / 2, 0}).direction;
        EXPECT_NEAR(dot(Vec3d(top), exact.up) / dot(Vec3d(top), exact.forward),
                    exact.tanY + exact.low, 1e-5 * exact.tanY);
    }
}

/// Solid angle of a triangle of unit vectors [van Oosterom and Strackee 1983].
double solidAngle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return std::abs(2 * std::atan2(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a)));
}

TEST(Camera, DensityIntegratesToOneOverAPixel) {
    for (const View& v : views()) {
        SCOPED_TRACE(v.name);
        const Camera camera(v.description, v.offset, v.film, {});
        const Exact exact(v);
        const int w = v.film.width, h = v.film.height;
        const int pixels[4][2] = {{0, 0}, {w - 1, h / 2}, {w / 2, h - 1}, {w / 2, h / 2}};
        for (const auto& pixel : pixels) {
            constexpr int kSteps = 12;
            double sum = 0;
            for (int i = 0; i < kSteps * kSteps; ++i) {
                const double step = 1.0 / kSteps;
                const double x = pixel[0] + (i % kSteps) * step, y = pixel[1] + (i / kSteps) * step;
                const Vec3d a = normalize(exact.onImagePlane(x, y)),
                            b = normalize(exact.onImagePlane(x + step, y)),
                            c = normalize(exact.onImagePlane(x + step, y + step)),
                            d = normalize(exact.onImagePlane(x, y + step));
                const Vec2 middle{float(x + step / 2), float(y + step / 2)};
                sum += (solidAngle(a, b, c) + solidAngle(a, c, d)) *
                       camera.directionAt(camera.position(), middle).pdfW;
            }
            EXPECT_NEAR(sum, 1, 5e-3);
        }
    }
}

TEST(Camera, ThinLensInFocusIsSharp) {
    const View v = views()[4];
    const float focus = 5;
    const Camera camera(v.description, v.offset, v.film, {0.3f, focus});
    const Exact exact(v);
    Random random(3);
    double farthest = 0;
    for (int i = 0; i < 3000; ++i) {
        const Vec3 lens = camera.sampleLens({random.next(), random.next()});
        const Vec3d onLens = Vec3d(lens) - exact.position;
        ASSERT_NEAR(dot(onLens, exact.forward), 0, 1e-6);
        farthest = std::max(farthest, length(onLens));
        ASSERT_LE(length(onLens), 0.3 * (1 + 1e-5));
        // In focus, every point of the lens sees the same position. Elsewhere it is off by the
        // circle of confusion.
        const double x = random.real() * 333, y = random.real() * 222;
        for (const double depth : {1.0, 4.0, 1.0, 30.0}) {
            const Vec3d p = exact.onImagePlane(x, y) * (depth * focus);
            const Vec3d d = normalize(p - onLens);
            const Vec3d onFocus = onLens + d * (focus / dot(d, exact.forward));
            const Vec3d e = exact.rasterOf(onFocus);
            if (depth == 1.0) {
                ASSERT_NEAR(e.x, x, 1e-5);
            }
            const auto got = camera.project(lens, Vec3(d));
            const bool inside = e.x > 0.01 && e.y > 0.01 && e.x < 332.99 && e.y < 221.99;
            if (!inside) continue;
            ASSERT_TRUE(got);
            ASSERT_NEAR(got->raster.x, e.x, 1e-3);
            ASSERT_NEAR(got->raster.y, e.y, 1e-3);
        }
    }
    EXPECT_GT(farthest, 0.29);
}

TEST(Camera, SmallLensMeetsThePinhole) {
    const View v = views()[1];
    const Camera pinhole(v.description, v.offset, v.film, {});
    Random random(4);
    for (const float radius : {1e-3f, 1e-5f, 1e-8f}) {
        const Camera camera(v.description, v.offset, v.film, {radius, 2.0f});
        for (int i = 0; i < 500; ++i) {
            const Vec2 raster{random.next() * 1920, random.next() * 1080};
            const Vec3 lens = camera.sampleLens({random.next(), random.next()});
            const auto a = camera.directionAt(lens, raster);
            const auto b = pinhole.directionAt(pinhole.position(), raster);
            ASSERT_LT(length(a.direction - b.direction), radius + 1e-6f);
            ASSERT_NEAR(a.pdfW / b.pdfW, 1, 10 * radius + 1e-5f);
        }
    }
    EXPECT_EQ(pinhole.sampleLens({0.1f, 0.9f}), pinhole.position());
}

TEST(Camera, NothingBehindOrOutside) {
    for (const float radius : {0.0f, 0.1f}) {
        const View v = views()[0];
        const Camera camera(v.description, v.offset, v.film, {radius, 2.0f});
        const Exact exact(v);
        Random random(5);
        const Vec3 lens = camera.sampleLens({0.5f, 0.5f});
        for (int i = 0; i < 3000; ++i) {
            const double x = (3 * random.real() - 1) * 640, y = (3 * random.real() - 1) * 480;
            const Vec3d d = normalize(exact.onImagePlane(x, y));
            EXPECT_FALSE(camera.project(lens, Vec3(-d)));
            const double border = std::min(std::min(x, 640 - x), std::min(y, 480 - y));
            if (std::abs(border) < 0.01) continue;
            EXPECT_EQ(camera.project(lens, Vec3(d)).has_value(), border > 0) << x << " " << y;
        }
        EXPECT_FALSE(camera.project(lens, Vec3(exact.right)));
        EXPECT_FALSE(camera.project(lens, Vec3(exact.up)));
        // A direction on the film has a pixel: raster.x is never the width.
        for (int i = 0; i < 2000; ++i) {
            const Vec3 d = camera.directionAt(lens, {640, random.next() * 480}).direction;
            const auto p = camera.project(lens, d);
            if (p) {
                EXPECT_LT(p->raster.x, 640.0f);
            }
        }
    }
}

}  // namespace
}  // namespace lacuna::test
