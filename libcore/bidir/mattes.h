// The share of each pixel that each object and each material covers (image/cryptomatte.h).
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

/// Mattes of what the lens sees first, through panes and where alpha lets it. Shares come from 16 rays that lie evenly
/// over the pixel, or from 64 where those 16 do not agree. Objects without a name are called "unnamed", and objects of
/// one name count as one. For the pixels of `crop`; a pixel's values do not depend on the crop.
Mattes renderMattes(const Scene& scene, const Camera& camera, const PixelRect& crop,
                    std::uint64_t seed, const ThreadPool& pool);

}  // namespace lacuna
