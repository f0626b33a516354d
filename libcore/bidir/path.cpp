#include "libcore/bidir/path.h"

#include <cmath>

namespace lacuna {

namespace {
/// Cosine of the area measure at a vertex: 1 where it has no surface.
float measureCosine(const PathVertex& v, Vec3 direction) {
    return v.ng == Vec3{} ? 1.0f : std::fabs(dot(v.ng, direction));
}
}  // namespace

Edge edgeBetween(const PathVertex& a, const PathVertex& b) {
    Edge e;
    if (a.infinite() || b.infinite()) {
        const bool toInfinity = b.infinite();
        e.direction = toInfinity ? b.position : -a.position;
        const float cosine = measureCosine(toInfinity ? a : b, e.direction);
        e.toSecond = toInfinity ? 1.0f : cosine;
        e.toFirst = toInfinity ? cosine : 1.0f;
        e.geometry = cosine;
        return e;
    }
    // The difference in double: nearby vertices far from the origin keep their direction.
    const Vec3d d = Vec3d(b.position) - Vec3d(a.position);
    const double d2 = lengthSquared(d);
    if (!(d2 > 0.0)) return e;
    const double inverse = 1.0 / std::sqrt(d2);
    e.direction = Vec3(d * inverse);
    e.distance = float(d2 * inverse);
    const double inverse2 = 1.0 / d2;
    const double cosA = measureCosine(a, e.direction), cosB = measureCosine(b, e.direction);
    e.toSecond = float(cosB * inverse2);
    e.toFirst = float(cosA * inverse2);
    e.geometry = float(cosA * cosB * inverse2);
    return e;
}

LightPoint lightPointOf(const Lights& lights, const PathVertex& vertex) {
    if (vertex.infinite() && lights.kind(vertex.light) == LightKind::Environment) {
        return lights.environmentPoint(vertex.position);
    }
    if (lights.kind(vertex.light) == LightKind::Area) {
        return lights.areaPoint(vertex.light, vertex.position, vertex.ng, vertex.lightUv);
    }
    LightPoint p;
    p.light = vertex.light;
    p.kind = lights.kind(vertex.light);
    p.position = vertex.position;
    p.pdf = float(lights.pmf(vertex.light));
    return p;
}

}  // namespace lacuna
