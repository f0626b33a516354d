#include "render/method_layers.h"

#include <algorithm>
#include <optional>

#include "libcore/base/parallel.h"

namespace lacuna {

PartFilm::PartFilm(std::vector<std::string> names, int width, int height)
    : names_(std::move(names)),
      width_(width),
      height_(height),
      sums_(names_.size(), std::vector<Rgb>(std::size_t(width) * std::size_t(height))) {}

void PartFilm::add(const PathEvent& event) {
    if (!event.proposal || event.proposal->label >= sums_.size()) return;
    if (isFinite(event.contribution))
        sums_[event.proposal->label][event.pixel] += event.contribution;
}

void PartFilm::writeTo(LayeredImage& image, std::uint64_t iterations) const {
    const float scale = iterations > 0 ? 1.0f / float(iterations) : 0.0f;
    for (std::size_t part = 0; part < names_.size(); ++part) {
        Image layer(width_, height_);
        for (std::size_t i = 0; i < layer.pixels.size(); ++i) {
            layer.pixels[i] = sums_[part][i] * scale;
        }
        image.setRgb("part." + names_[part], layer);
    }
}

namespace {

/// A colour by the number that `numberOf` gives to what the middle of each pixel shows; black where
/// it gives none.
template <class Number>
Image numberLayer(const Scene& scene, const Camera& camera, const PixelRect& crop,
                  const ThreadPool& pool, const Number& numberOf) {
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
            // Neighbours in number are far apart in colour.
            const std::uint32_t h = (*number + 1u) * 2654435761u;
            const auto part = [h](int shift) {
                return 0.1f + 0.8f * float(h >> shift & 255u) / 255.0f;
            };
            layer.at(x - crop.x0, int(row)) = {part(24), part(16), part(8)};
        }
    });
    return layer;
}

}  // namespace

Image nodeLayer(const Scene& scene, const Camera& camera, const PixelRect& crop,
                const Skeleton& skeleton, const ThreadPool& pool) {
    return numberLayer(
        scene, camera, crop, pool,
        [&](const SurfacePoint& hit, Vec3 direction) -> std::optional<std::uint32_t> {
            const Vec3d side(dot(hit.ng, direction) > 0.0f ? -hit.ng : hit.ng);
            const std::uint16_t node = skeleton.map.at(Vec3d(hit.position), side);
            if (node == NodeMap::kNone) return std::nullopt;
            return node;
        });
}

namespace {

std::uint32_t eyeSubspaceOf(const SurfacePoint& hit, const Camera& camera,
                            const Subspaces& subspaces) {
    return subspaces.eyeTree(subpathEnd(hit.position, hit.ng, camera.position(), false));
}

}  // namespace

Image subspaceLayer(const Scene& scene, const Camera& camera, const PixelRect& crop,
                    const Subspaces& subspaces, const ThreadPool& pool) {
    return numberLayer(scene, camera, crop, pool,
                       [&](const SurfacePoint& hit, Vec3) -> std::optional<std::uint32_t> {
                           return eyeSubspaceOf(hit, camera, subspaces);
                       });
}

Image lightSubspaceLayer(const Scene& scene, const Camera& camera, const PixelRect& crop,
                         const Subspaces& subspaces, const ThreadPool& pool) {
    return numberLayer(
        scene, camera, crop, pool,
        [&](const SurfacePoint& hit, Vec3) -> std::optional<std::uint32_t> {
            const auto column = subspaces.column(eyeSubspaceOf(hit, camera, subspaces));
            return std::uint32_t(std::max_element(column.begin(), column.end()) - column.begin());
        });
}

}  // namespace lacuna
