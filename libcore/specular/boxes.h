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

/// At most 2^divisions parts of the triangles, none where there are none. A box is `margin` wider than
/// its triangles on each side.
std::vector<BoxedTriangles> inBoxes(std::vector<std::array<Vec3, 3>> triangles, int divisions,
                                    float margin);

/// The box of some triangles, of which there must be one, and `margin` wider on each side.
Box around(std::span<const std::array<Vec3, 3>> triangles, float margin);

/// The box of some boxes, of which there must be one.
Box around(std::span<const BoxedTriangles> parts);

/// Whether some straight way from a point of the one box to a point of the other meets the third one.
/// Never false where one does by more than rounding.
bool mayLieBetween(const Box& third, const Box& one, const Box& other);

}  // namespace lacuna
