#include "libcore/specular/snell.h"

#include <cmath>

namespace lacuna {

namespace {

/// How far to the side a ray crosses the plane, from a point `deep` below it to one that is `wide` to the side and
/// `high` above: where its optical length is least. The slope of the length grows with the place and is zero there.
/// Newton's method finds it, and halves the interval where a step would leave it.
double sidewaysAt(double deep, double high, double wide, double index) {
    constexpr int kMostSteps = 40;
    constexpr double kConverged = 1e-12;  // of `wide`: rounding in double
    double low = 0.0, most = wide, x = wide * deep / (deep + index * high);
    for (int i = 0; i < kMostSteps && most - low > kConverged * wide; ++i) {
        const double rest = wide - x, before = std::hypot(x, deep), behind = std::hypot(rest, high);
        const double slope = index * x / before - rest / behind;
        (slope > 0.0 ? most : low) = x;
        const double bend = index * deep * deep / (before * before * before) +
                            high * high / (behind * behind * behind);
        const double step = slope / bend;
        if (std::fabs(step) <= kConverged * wide) break;
        x = x - step > low && x - step < most ? x - step : 0.5 * (low + most);
    }
    return x;
}

}  // namespace

std::optional<Vec3d> refractedWay(const Vec3d& from, const Interface& plane,
                                  const ChainTarget& target) {
    const Vec3d& n = plane.normal;
    const double deep = plane.offset - dot(from, n);
    const Vec3d way = target.wayFrom(from);
    const double along = dot(way, n), high = target.infinite ? along : along - deep;
    if (!(deep > 0.0 && high > 0.0)) return std::nullopt;
    const Vec3d across = way - n * along;
    if (target.infinite) {
        const Vec3d sine = across * (1.0 / plane.index);
        const double squared = 1.0 - lengthSquared(sine);
        if (!(squared > 0.0)) return std::nullopt;
        return normalize(sine + n * std::sqrt(squared));
    }
    const double wide = length(across);
    const double x = sidewaysAt(deep, high, wide, plane.index);
    return normalize(normalize(across) * x + n * deep);
}

}  // namespace lacuna
