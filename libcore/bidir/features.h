// Features of what a picture shows, without light: the layers albedo, normal, Z and position.
//
// Z and position are of the first surface that the lens sees. A compositor needs them to put things in front of it or
// behind it. Albedo and normal are for denoisers, which need the surface that a pixel's pattern comes from. That is the
// first one that has a lobe with a density, seen over mirrors and through smooth glass. (render/README.md, "Denoisers")
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/base/parallel.h"
#include "libcore/bidir/film.h"
#include "libcore/scene/scene.h"

namespace lacuna {

/// Means over a few primary rays per pixel; zero where nothing is hit (so every layer is finite).
struct FeatureLayers {
    Image
        albedo;  ///< Bsdf::layerAlbedo, [0, 1]; behind mirrors and glass times what these let through
    Image normal;  ///< shading normal towards where it is seen from, in the file's coordinates
    std::vector<float> z = {};  ///< distance along the viewing axis, mean over the rays that hit
    std::vector<Vec3> position = {};  ///< in the file's coordinates, mean over the rays that hit
};

/// For the pixels of `crop`; a pixel's values do not depend on the crop. Throws InterruptedError soon
/// after `cancel` became true.
FeatureLayers renderFeatures(const Scene& scene, const Camera& camera, const PixelRect& crop,
                             std::uint64_t seed, const ThreadPool& pool,
                             const std::atomic<bool>& cancel = kNeverCancelled);

}  // namespace lacuna
