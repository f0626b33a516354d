// Whether a triangle and a closed box have a point in common, decided exactly.
#pragma once

#include <array>

#include "libcore/base/vec.h"

namespace lacuna {

using TriangleD = std::array<Vec3d, 3>;

/// Exact for any finite doubles. Touching counts. A separating-axis test in double answers unless
/// rounding could have turned it over; then CGAL's exact predicate does. On boxes about a closed
/// scene that is one test in some thousands, so the exact answer costs nothing measurable
/// (preprocess/README.md).
bool overlaps(const TriangleD& triangle, const Vec3d& low, const Vec3d& high);

/// CGAL's exact predicate alone: the oracle of the tests.
bool overlapsByCgal(const TriangleD& triangle, const Vec3d& low, const Vec3d& high);

}  // namespace lacuna
