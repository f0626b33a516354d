// The normal of a triangle, on which hits, emitters and the test for degenerate triangles must
// agree.
#pragma once

#include "libcore/base/vec.h"

namespace lacuna {

/// Unit normal on the side from which the corners run counter-clockwise; zero for a degenerate
/// triangle (or one that is not finite). Computed in double: in float, squares underflow for edges
/// below 1e-9, and slivers lose their digits.
inline Vec3 triangleNormal(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3d p(a);
    const Vec3d n = normalize(cross(Vec3d(b) - p, Vec3d(c) - p));
    return isFinite(n) ? Vec3(n) : Vec3{};
}

}  // namespace lacuna
