// The first surface along a ray, as layers beside a picture know it: panes are looked through.
#pragma once

#include <optional>

#include "libcore/scene/scene.h"

namespace lacuna {

/// A ray before it meets anything.
struct Sight {
    Vec3 origin, ng;  ///< ng: of the surface that it leaves; zero at the lens
    Vec3 direction;   ///< unit
    RayKind kind = RayKind::Camera;
};

/// The primary ray through `raster` from the lens point of `u`, in [0, 1)^2.
Sight sightThrough(const Camera& camera, Vec2 raster, Vec2 u);

/// Every ray passes panes here, whether it would stop there or not: the few that do would be specks.
/// Empty where nothing is met.
std::optional<SurfacePoint> firstSeen(const Scene& scene, const Sight& sight, RayTally& tally);

}  // namespace lacuna
