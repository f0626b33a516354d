// Exact test whether a triangle and a closed box have a point in common.
#pragma once

#include <array>

#include "libcore/base/vec.h"

namespace lacuna {

using TriangleD = std::array<Vec3d, 3>;

/// Whether the triangle and the closed box have a point in common; touching counts. Exact for any
/// finite doubles. A separating-axis test in double decides unless rounding could change its
/// result; then CGAL's exact predicate decides. In voxelization this is one test in some thousands,
/// so that exactness costs nothing measurable (preprocess/README.md).
bool overlaps(const TriangleD& triangle, const Vec3d& low, const Vec3d& high);

/// CGAL's exact predicate alone: the oracle of the tests.
bool overlapsByCgal(const TriangleD& triangle, const Vec3d& low, const Vec3d& high);

}  // namespace lacuna
