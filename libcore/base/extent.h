// How large scenes may be, in their own units.
#pragma once

namespace lacuna {

/// How far from the scene's middle surfaces, lamps and cameras may be, and how wide a lens: squares
/// of distances are floats then, and so are areas; Embree takes no ray from beyond 1.8e18.
inline constexpr double kFarthest = 1e17;
/// The nearest plane in focus: its square is a float as well.
inline constexpr double kNearestFocus = 1e-15;

}  // namespace lacuna
