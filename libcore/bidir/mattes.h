// How much of each pixel is covered by which object and which material (image/cryptomatte.h).
#pragma once

#include <cstdint>

#include "libcore/bidir/film.h"
#include "libcore/image/cryptomatte.h"
#include "libcore/scene/scene.h"

namespace lacuna {

class ThreadPool;

struct Mattes {
    Matte objects;    ///< by the names of nodes
    Matte materials;  ///< by those of materials
};

/// Of what the lens sees first, through panes, as alpha lets it: shares of 16 rays that lie evenly over
/// the pixel, and of 64 where those 16 do not agree. What has no name is called "unnamed"; things of
/// one name are one. For the pixels of `crop`; a pixel's values do not depend on the crop.
Mattes renderMattes(const Scene& scene, const Camera& camera, const PixelRect& crop,
                    std::uint64_t seed, const ThreadPool& pool);

}  // namespace lacuna
