// The only file that includes CGAL: its predicates need -frounding-math, and its headers take
// seconds to compile.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include "libcore/voxel/exact_overlap.h"

namespace lacuna {

bool overlapsByCgal(const TriangleD& t, const Vec3d& low, const Vec3d& high) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    const auto point = [](const Vec3d& p) { return Kernel::Point_3(p.x, p.y, p.z); };
    return CGAL::do_intersect(Kernel::Triangle_3(point(t[0]), point(t[1]), point(t[2])),
                              Kernel::Iso_cuboid_3(point(low), point(high)));
}

}  // namespace lacuna
