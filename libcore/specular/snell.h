// The way from one point to another through a plane between two media. (theory.md, "Next event through glass")
#pragma once

#include <optional>

#include "libcore/base/vec.h"

namespace lacuna {

/// Where a chain ends: a light without an extent, or a point of one.
struct ChainTarget {
    Vec3 position;  ///< at infinity: unit direction towards the light
    bool infinite = false;

    /// From `place` to the target; at infinity a unit vector.
    Vec3d wayFrom(const Vec3d& place) const {
        return infinite ? Vec3d(position) : Vec3d(position) - place;
    }
};

/// A plane between two media, which a ray passes along the plane's normal.
struct Interface {
    Vec3d normal;   ///< unit
    double offset;  ///< of its points along the normal
    double index;   ///< of the medium behind it over that in front of it
};

/// The unit direction from a point behind the plane that the plane refracts to the target, by Snell's law. Empty where
/// the target is not in front of the plane, or there is no such direction.
std::optional<Vec3d> refractedWay(const Vec3d& from, const Interface& plane,
                                  const ChainTarget& target);

}  // namespace lacuna
