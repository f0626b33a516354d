#include "libcore/bidir/path.h"

namespace lacuna {

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
