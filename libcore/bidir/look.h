// The surface that a pixel's pattern comes from, for denoisers: albedo and normal along a ray.
#pragma once

#include "libcore/bidir/first_seen.h"

namespace lacuna {

struct Look {
    Rgb albedo;   ///< in [0, 1]
    Vec3 normal;  ///< at most of length 1
};

/// Follows `sight` from `point`, which it has met, to the first surfaces that have a lobe with a density. At a mirror
/// or smooth glass it splits into the reflected and the transmitted part, weighted by their shares. Nothing is drawn at
/// random, so the result has no noise. A part that reaches no such surface within a few events, or whose share is
/// small, is white, with the normal of the surface where it was left. A part that meets nothing adds nothing.
Look lookFrom(const Scene& scene, const Sight& sight, const SurfacePoint& point, RayTally& tally);

}  // namespace lacuna
