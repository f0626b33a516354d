#include "libcore/voxel/exact_overlap.h"

#include <algorithm>
#include <cmath>

namespace lacuna {

namespace {

enum class Answer { Apart, Together, Doubtful };

/// Test of separating axes [Akenine-Moeller 2001]: the box's normals, the triangle's normal, and
/// the cross products of their edges. The gap along each axis is compared with a bound on its
/// rounding error.
Answer bySeparatingAxes(const TriangleD& t, const Vec3d& low, const Vec3d& high) {
    for (std::size_t a = 0; a < 3; ++a) {  // comparisons of given numbers: exact
        if (std::max({t[0][a], t[1][a], t[2][a]}) < low[a]) return Answer::Apart;
        if (std::min({t[0][a], t[1][a], t[2][a]}) > high[a]) return Answer::Apart;
    }
    const Vec3d centre = (low + high) * 0.5, half = (high - low) * 0.5;
    const Vec3d v[3] = {t[0] - centre, t[1] - centre, t[2] - centre};
    double size = 0.0;  // largest magnitude of the coordinates
    for (std::size_t a = 0; a < 3; ++a) {
        size = std::max({size, std::fabs(low[a]), std::fabs(high[a])});
        for (const Vec3d& p : t) size = std::max(size, std::fabs(p[a]));
    }
    bool doubtful = false;
    const auto apart = [&](const Vec3d& axis, double axisError) {
        const double p0 = dot(axis, v[0]), p1 = dot(axis, v[1]), p2 = dot(axis, v[2]);
        const Vec3d magnitude{std::fabs(axis.x), std::fabs(axis.y), std::fabs(axis.z)};
        const double reach = dot(magnitude, half);
        const double gap =
            std::max(std::min({p0, p1, p2}) - reach, -std::max({p0, p1, p2}) - reach);
        const double error =
            1e-14 * size * (magnitude.x + magnitude.y + magnitude.z) + 8.0 * axisError * size;
        if (gap > error) return true;
        doubtful |= gap > -error;
        return false;
    };
    const Vec3d edges[3] = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
    const Vec3d units[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const Vec3d& edge : edges) {
        for (const Vec3d& unit : units) {
            if (apart(cross(edge, unit), 1e-15 * size)) return Answer::Apart;
        }
    }
    // The normal is a product of two lengths, each up to `size`, and rounds accordingly.
    if (apart(cross(edges[0], edges[1]), 1e-15 * size * size)) return Answer::Apart;
    return doubtful ? Answer::Doubtful : Answer::Together;
}

}  // namespace

bool overlaps(const TriangleD& t, const Vec3d& low, const Vec3d& high) {
    const Answer answer = bySeparatingAxes(t, low, high);
    if (answer != Answer::Doubtful) return answer == Answer::Together;
    return overlapsByCgal(t, low, high);
}

}  // namespace lacuna
