#include "libcore/bidir/first_seen.h"

namespace lacuna {

namespace {
constexpr int kMostPanes = 64;  // one behind the other; no scene has as many
}

Sight sightThrough(const Camera& camera, Vec2 raster, Vec2 u) {
    const Vec3 lens = camera.sampleLens(u);
    return {lens, Vec3{}, camera.directionAt(lens, raster).direction};
}

std::optional<SurfacePoint> firstSeen(const Scene& scene, const Sight& sight, RayTally& tally) {
    auto hit = scene.intersect(sight.origin, sight.ng, sight.direction, sight.kind, tally);
    for (int i = 0; hit && i < kMostPanes; ++i) {
        if (!scene.description().materials[hit->material].pane) break;
        if (!(scene.bsdfAt(*hit).passing(sight.direction) > 0.0f)) break;
        hit = scene.intersect(hit->position, hit->ng, sight.direction, sight.kind, tally);
    }
    return hit;
}

}  // namespace lacuna
