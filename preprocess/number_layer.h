// Layers that show to which node or subspace visible surfaces belong.
#pragma once

#include <optional>

#include "libcore/base/parallel.h"
#include "libcore/bidir/film.h"
#include "libcore/image/image.h"
#include "libcore/scene/scene.h"

namespace lacuna {

/// A layer of colours: for the visible point at the centre of each pixel of `crop`, `numberOf`
/// (point, direction of the ray) returns a number, which determines the colour. Black if it returns
/// none.
template <class NumberOf>
Image numberLayer(const Scene& scene, const Camera& camera, const PixelRect& crop,
                  const ThreadPool& pool, const NumberOf& numberOf) {
    Image layer(crop.width(), crop.height());
    pool.forEach(std::size_t(crop.height()), [&](std::size_t row) {
        RayTally tally;
        for (int x = crop.x0; x < crop.x1; ++x) {
            const Vec2 raster{float(x) + 0.5f, float(crop.y0 + int(row)) + 0.5f};
            const Vec3 direction = camera.directionAt(camera.position(), raster).direction;
            const auto hit =
                scene.intersect(camera.position(), {}, direction, RayKind::Camera, tally);
            if (!hit) continue;
            const std::optional<std::uint32_t> number = numberOf(*hit, direction);
            if (!number) continue;
            // Successive numbers get very different colours.
            const std::uint32_t h = (*number + 1u) * 2654435761u;
            const auto part = [h](int shift) {
                return 0.1f + 0.8f * float(h >> shift & 255u) / 255.0f;
            };
            layer.at(x - crop.x0, int(row)) = {part(24), part(16), part(8)};
        }
    });
    return layer;
}

}  // namespace lacuna
