// The first surface along a ray, for the layers beside the picture. Panes are looked through.
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

/// The first surface that is no pane. Panes stop a few rays of the render, which would be specks in the layers; here
/// all rays pass. Empty where nothing is met.
std::optional<SurfacePoint> firstSeen(const Scene& scene, const Sight& sight, RayTally& tally);

}  // namespace lacuna
