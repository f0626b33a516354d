#include "libcore/bidir/scene_paths.h"

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
    const auto atEye = [&] { return z.bsdf.evaluate(z.toPrevious, -edge.direction).f; };
    // Every material that scatters reflects. So the material is asked only about light from behind.
    if (leadsBehind(z, -edge.direction) && isBlack(atEye())) return {};
    const Rgb flow = y.throughput * lightEnd(walker_, y, edge.direction, z).f;
    const Rgb scattered = throughEye && !isBlack(flow) ? flow * atEye() : Rgb{};
    return {flow, scattered, double(edge.geometry)};
}

float ScenePaths::reach(const Vec3& origin, const Vec3& direction, RayTally& tally) const {
    const auto hit = walker_.scene().trace(origin, Vec3{}, direction, RayKind::Cache, tally);
    return hit ? hit->distance : std::numeric_limits<float>::infinity();
}

}  // namespace lacuna
