#include "libcore/bidir/path_space.h"

#include <limits>

namespace lacuna {

void ScenePaths::traceEye(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const {
    const Camera::Film film = walker_.camera().film();
    const float u1 = rng.uniform(), u2 = rng.uniform();
    walker_.traceEye({u1 * float(film.width), u2 * float(film.height)}, rng, tally, out);
}

PathSpace::Arrival ScenePaths::arrival(Subpath light, Subpath eye, bool throughEye) const {
    const PathVertex &y = light.back(), &z = eye.back();
    const Edge edge = edgeBetween(y, z);
    if (!(edge.geometry > 0.0f)) return {};
    // Whatever scatters at all reflects: only what comes from behind has to ask the material.
    const bool behind = leadsBehind(z, -edge.direction);
    Rgb atEye{};
    if (throughEye || behind) {
        atEye = z.bsdf.evaluate(z.toPrevious, -edge.direction).f;
        if (behind && isBlack(atEye)) return {};
    }
    const Rgb flow = y.throughput * lightEnd(walker_.scene().lights(), y, edge.direction).f;
    return {flow, throughEye ? flow * atEye : Rgb{}, double(edge.geometry)};
}

float ScenePaths::reach(const Vec3& origin, const Vec3& direction, RayTally& tally) const {
    const auto hit = walker_.scene().trace(origin, Vec3{}, direction, RayKind::Cache, tally);
    return hit ? hit->distance : std::numeric_limits<float>::infinity();
}

}  // namespace lacuna
