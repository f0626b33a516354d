// What denoisers are told of a ray: the surface that a pixel's pattern comes from.
#pragma once

#include "libcore/bidir/first_seen.h"

namespace lacuna {

struct Look {
    Rgb albedo;   ///< in [0, 1]
    Vec3 normal;  ///< at most of length 1
};

/// From where `sight` has met `point` to the first surfaces that have a lobe with a density. At a mirror or smooth glass
/// it parts into what is reflected and what goes through, by their shares, as often as that shows:
/// nothing is drawn, so nothing is noisy. A part that comes to no end, or holds little, is white, with
/// the normal of where it was left; one that meets nothing adds nothing.
Look lookFrom(const Scene& scene, const Sight& sight, const SurfacePoint& point, RayTally& tally);

}  // namespace lacuna
