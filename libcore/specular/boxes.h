// Boxes around triangles that lie together.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

struct Box {
    Vec3 low, high;
};

/// Some triangles, and a box around them.
struct BoxedTriangles {
    Box box;
    std::vector<std::array<Vec3, 3>> triangles;
};

/// Divides the triangles into at most 2^divisions parts; empty without triangles. A box is `margin` wider than its
/// triangles on each side.
std::vector<BoxedTriangles> inBoxes(std::vector<std::array<Vec3, 3>> triangles, int divisions,
                                    float margin);

/// The box of some triangles, of which there must be one, and `margin` wider on each side.
Box around(std::span<const std::array<Vec3, 3>> triangles, float margin);

/// The box of some boxes, of which there must be one.
Box around(std::span<const BoxedTriangles> parts);

/// Whether some straight line from a point of `one` to a point of `other` meets `third`. Never false where one does,
/// up to rounding.
bool mayLieBetween(const Box& third, const Box& one, const Box& other);

}  // namespace lacuna
