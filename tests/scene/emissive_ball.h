// A lamp in the shape of a modeller's sphere.
#pragma once

#include <cmath>
#include <vector>

#include "libcore/base/sampling.h"
#include "libcore/scene/light.h"

namespace lacuna::test {

/// A ball with `rings` from pole to pole and twice as many sides around. The seam's corners have
/// the rounding of the sine of a whole turn. Degenerate triangles at the poles are included.
inline std::vector<EmissiveTriangle> emissiveBall(Vec3 middle, float radius, int rings) {
    const auto corner = [&](int i, int j) {
        const float turn = kPi * float(i) / float(rings), down = kPi * float(j) / float(rings);
        return middle + Vec3{std::sin(down) * std::cos(turn), std::cos(down),
                             -std::sin(down) * std::sin(turn)} *
                            radius;
    };
    std::vector<EmissiveTriangle> triangles;
    for (int j = 0; j < rings; ++j) {
        for (int i = 0; i < 2 * rings; ++i) {
            EmissiveTriangle t;
            t.radiance = Rgb(1.0f);
            t.corners = {corner(i, j), corner(i, j + 1), corner(i + 1, j + 1)};
            triangles.push_back(t);
            t.corners = {corner(i, j), corner(i + 1, j + 1), corner(i + 1, j)};
            triangles.push_back(t);
        }
    }
    return triangles;
}

}  // namespace lacuna::test
