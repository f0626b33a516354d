// What the lens sees first, without light: the layers albedo, normal and Z beside a picture.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/bidir/film.h"
#include "libcore/scene/scene.h"

namespace lacuna {

class ThreadPool;

/// Means over a few primary rays per pixel; zero where nothing is hit (so every layer is finite).
struct FeatureLayers {
    Image albedo;          ///< Bsdf::layerAlbedo
    Image normal;          ///< shading normal turned towards the camera, in the file's coordinates
    std::vector<float> z;  ///< distance along the viewing axis, mean over the rays that hit
};

/// For the pixels of `crop`; a pixel's values do not depend on the crop.
FeatureLayers renderFeatures(const Scene& scene, const Camera& camera, const PixelRect& crop,
                             std::uint64_t seed, const ThreadPool& pool);

}  // namespace lacuna
