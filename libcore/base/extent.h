// How large scenes may be, in scene units.
#pragma once

namespace lacuna {

/// The largest distance of surfaces, lamps and cameras from the scene's centre, and the largest
/// width of a lens. Within it, squared distances and areas fit into a float. Embree takes no ray
/// from beyond 1.8e18.
inline constexpr double kFarthest = 1e17;
/// The smallest distance of the plane in focus. Its square fits into a float as well.
inline constexpr double kNearestFocus = 1e-15;

}  // namespace lacuna
