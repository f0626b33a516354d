#include "libcore/bidir/features.h"

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"

namespace lacuna {

namespace {
constexpr int kSamples = 4;
constexpr int kMostPanes = 64;  // one behind the other; no scene has as many

/// What the lens sees first. Every ray passes panes here, whether it would stop there or not: the few that
/// do would be specks.
std::optional<SurfacePoint> firstSeen(const Scene& scene, const Vec3& lens, const Vec3& direction,
                                      RayTally& tally) {
    auto hit = scene.intersect(lens, Vec3{}, direction, RayKind::Camera, tally);
    for (int i = 0; hit && i < kMostPanes && scene.bsdfAt(*hit).passing(direction) > 0.0f; ++i) {
        hit = scene.intersect(hit->position, hit->ng, direction, RayKind::Camera, tally);
    }
    return hit;
}

}  // namespace

FeatureLayers renderFeatures(const Scene& scene, const Camera& camera, const PixelRect& crop,
                             std::uint64_t seed, const ThreadPool& pool) {
    FeatureLayers layers{
        Image(crop.width(), crop.height()), Image(crop.width(), crop.height()), {}};
    layers.z.resize(layers.albedo.pixels.size());
    const auto filmWidth = std::uint64_t(camera.film().width);

    pool.forEach(std::size_t(crop.height()), [&](std::size_t row) {
        RayTally tally;  // not part of the render: these rays are counted nowhere
        const int y = crop.y0 + int(row);
        for (int x = crop.x0; x < crop.x1; ++x) {
            const std::size_t pixel = row * std::size_t(crop.width()) + std::size_t(x - crop.x0);
            Rng rng(seed, 0, StreamKind::Features, std::uint64_t(y) * filmWidth + std::uint64_t(x));
            Rgb albedo{};
            Vec3 normal{};
            double z = 0.0;
            int hits = 0;
            for (int i = 0; i < kSamples; ++i) {
                const float jitterX = rng.uniform(), jitterY = rng.uniform();
                const float u1 = rng.uniform(), u2 = rng.uniform();
                const Vec3 lens = camera.sampleLens({u1, u2});
                const Vec3 direction =
                    camera.directionAt(lens, {float(x) + jitterX, float(y) + jitterY}).direction;
                const auto hit = firstSeen(scene, lens, direction, tally);
                if (!hit) continue;
                const Bsdf bsdf = scene.bsdfAt(*hit);
                albedo += bsdf.layerAlbedo();
                normal += dot(bsdf.ns(), direction) > 0.0f ? -bsdf.ns() : bsdf.ns();
                z += dot(Vec3d(hit->position) - Vec3d(camera.position()), Vec3d(camera.forward()));
                ++hits;
            }
            const float share = 1.0f / float(kSamples);
            layers.albedo.pixels[pixel] = albedo * share;
            layers.normal.pixels[pixel] = Rgb(normal.x, normal.y, normal.z) * share;
            layers.z[pixel] = hits > 0 ? float(z / hits) : 0.0f;
        }
    });
    return layers;
}

}  // namespace lacuna
