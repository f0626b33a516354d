#include "libcore/bidir/features.h"

#include "libcore/base/error.h"
#include "libcore/base/rng.h"
#include "libcore/bidir/look.h"

namespace lacuna {

namespace {
constexpr int kSamples = 4;
}

FeatureLayers renderFeatures(const Scene& scene, const Camera& camera, const PixelRect& crop,
                             std::uint64_t seed, const ThreadPool& pool,
                             const std::atomic<bool>& cancel) {
    FeatureLayers layers{
        Image(crop.width(), crop.height()), Image(crop.width(), crop.height()), {}, {}};
    layers.z.resize(layers.albedo.pixels.size());
    layers.position.resize(layers.albedo.pixels.size());
    const auto filmWidth = std::uint64_t(camera.film().width);

    pool.forEach(std::size_t(crop.height()), [&](std::size_t row) {
        if (cancel) return;
        RayTally tally;  // not part of the render: these rays are counted nowhere
        const int y = crop.y0 + int(row);
        for (int x = crop.x0; x < crop.x1; ++x) {
            const std::size_t pixel = row * std::size_t(crop.width()) + std::size_t(x - crop.x0);
            Rng rng(seed, 0, StreamKind::Features, std::uint64_t(y) * filmWidth + std::uint64_t(x));
            Look sum;
            double z = 0.0;
            Vec3d position;
            int hits = 0;
            for (int i = 0; i < kSamples; ++i) {
                const float jitterX = rng.uniform(), jitterY = rng.uniform();
                const float u1 = rng.uniform(), u2 = rng.uniform();
                const Sight sight =
                    sightThrough(camera, {float(x) + jitterX, float(y) + jitterY}, {u1, u2});
                const auto hit = firstSeen(scene, sight, tally);
                if (!hit) continue;
                const Look look = lookFrom(scene, sight, *hit, tally);
                sum.albedo += look.albedo;
                sum.normal += look.normal;
                z += dot(Vec3d(hit->position) - Vec3d(camera.position()), Vec3d(camera.forward()));
                position += Vec3d(hit->position) + scene.centre();
                ++hits;
            }
            const float share = 1.0f / float(kSamples);
            layers.albedo.pixels[pixel] = sum.albedo * share;
            layers.normal.pixels[pixel] = Rgb(sum.normal.x, sum.normal.y, sum.normal.z) * share;
            if (hits == 0) continue;
            layers.z[pixel] = float(z / hits);
            layers.position[pixel] = Vec3(position * (1.0 / hits));
        }
    });
    if (cancel) throw InterruptedError("interrupted: nothing was written");
    return layers;
}

}  // namespace lacuna
