// Map between the square [-1, 1]^2 and all directions.
#pragma once

#include <cmath>

#include "libcore/base/vec.h"

namespace lacuna {

/// Unit direction of a point of [-1, 1]^2: the octahedron |x| + |y| + |z| = 1, whose lower half is
/// folded outwards [Praun03].
inline Vec3 octahedronDirection(Vec2 p) {
    Vec3 d{p.x, p.y, 1.0f - std::abs(p.x) - std::abs(p.y)};
    if (d.z < 0.0f) {
        const float x = d.x;
        d.x = std::copysign(1.0f - std::abs(d.y), x);
        d.y = std::copysign(1.0f - std::abs(x), d.y);
    }
    return normalize(d);
}

/// The point in [-1, 1]^2 of a direction, which need not be unit but not zero.
inline Vec2 octahedronPoint(const Vec3& d) {
    const float sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
    const float x = d.x / sum, y = d.y / sum;
    if (d.z >= 0.0f) return {x, y};
    return {std::copysign(1.0f - std::abs(y), x), std::copysign(1.0f - std::abs(x), y)};
}

}  // namespace lacuna
