#include "libcore/bidir/refracted_lamps.h"

#include <algorithm>

#include "libcore/bidir/chain_vertices.h"

namespace lacuna {

namespace {

/// What a walk's path may differ from a chain in double between the same ends: the angle of its first
/// direction, and by how far of the scene's radius rays leave surfaces.
constexpr double kAngle = 1e-3, kOffset = 1e-5;

/// What a chain is a function of.
ChainQuery queryOf(const PathVertex& z, const PathVertex& y0) {
    return {{z.position, z.ng, {}}, {y0.position, y0.infinite()}, Chain::kMost};
}

}  // namespace

/// Of deep vertices there are many, and each carries little.
double RefractedLamps::samplesAt(const PathVertex& z, int order) const {
    constexpr double kByOrder[] = {1.0, 0.5, 0.25};
    return effort_ * kByOrder[std::min(order, 3) - 1] * glass_->shadows().triesAt(z.position);
}

/// The one chain that the straight ray leads to, or from within glass a guess: a function of the two, whichever
/// walk made z. No ray is traced where the lamp lies behind z or nothing lies between.
std::optional<RefractedLamps::Joined> RefractedLamps::straight(const PathVertex& z,
                                                               const PathVertex& y0,
                                                               RayTally& tally) const {
    const Vec3 way = y0.infinite() ? y0.position : y0.position - z.position;
    if (!(lengthSquared(way) > 0.0f)) return std::nullopt;
    if (!z.bsdf.transmits() && leadsBehind(z, way)) return std::nullopt;
    if (!glass_->boxes().mayLieOn(z.position, way, y0.infinite())) return std::nullopt;
    const ChainQuery query = queryOf(z, y0);
    const Vec3d straightOn = normalize(query.target.wayFrom(Vec3d(z.position)));
    std::optional<FoundChain> found = solver_.throughGlass(query, straightOn, tally);
    if (!found) {
        const GlassBodies::WaysOut guesses =
            glass_->bodies().roughWaysOut(z.position, query.target);
        for (std::size_t i = 0; i < guesses.size() && !found; ++i) {
            found = solver_.throughGlass(query, guesses[i].direction, tally);
        }
    }
    return found ? std::optional(Joined{*found, 1.0}) : std::nullopt;
}

/// One that leaves the body around z by the face of `way`, of all `ways`.
std::optional<RefractedLamps::Joined> RefractedLamps::out(const GlassBodies::WaysOut& ways,
                                                          const GlassBodies::WayOut& way,
                                                          const PathVertex& z, const PathVertex& y0,
                                                          RayTally& tally) const {
    if (!z.bsdf.transmits() && leadsBehind(z, Vec3(way.direction))) return std::nullopt;
    auto found = solver_.throughGlass(queryOf(z, y0), way.direction, tally);
    if (!found || ways.through(found->chain[0].point.ng) != &way) return std::nullopt;
    return Joined{*found, 1.0 / double(ways.size())};
}

/// One of the chains between the two, if Newton's method finds it.
std::optional<RefractedLamps::Joined> RefractedLamps::drawBetween(const PathVertex& z,
                                                                  const PathVertex& y0, double u,
                                                                  RayTally& tally) const {
    const GlassBodies::WaysOut ways = glass_->bodies().waysOut(z.position, queryOf(z, y0).target);
    if (ways.size() == 0) return straight(z, y0, tally);
    const auto i = std::min(ways.size() - 1, std::size_t(u * double(ways.size())));
    return out(ways, ways[i], z, y0, tally);
}

/// That one of them whose first vertex, from z, is on a face with this normal.
std::optional<RefractedLamps::Joined> RefractedLamps::betweenOver(const Vec3& normal,
                                                                  const PathVertex& z,
                                                                  const PathVertex& y0,
                                                                  RayTally& tally) const {
    const GlassBodies::WaysOut ways = glass_->bodies().waysOut(z.position, queryOf(z, y0).target);
    if (ways.size() == 0) return straight(z, y0, tally);
    const GlassBodies::WayOut* way = ways.through(normal);
    return way ? out(ways, *way, z, y0, tally) : std::nullopt;
}

/// p(y_0) and the chain's pmf, likewise.
double RefractedLamps::densityAt(const PathVertex& y0, double seenSamples,
                                 const Joined& joined) const {
    return densityOfNextEvent(walker_, joined.found, y0) * seenSamples * joined.pmf;
}

/// That of a path through so many refractions, `last` the one next to z.
double RefractedLamps::densityOfChain(const PathVertex& z, const PathVertex& y0,
                                      const PathVertex& last, std::size_t vertices,
                                      const Vec3& toChain, RayTally& tally) const {
    const double seenSamples = walker_.seenSamples(y0, z);
    if (!(seenSamples > 0.0)) return 0.0;
    const auto joined = betweenOver(last.ng, z, y0, tally);
    if (!joined || joined->found.chain.size() != vertices) return 0.0;
    const double distance = length(Vec3d(last.position) - Vec3d(z.position));
    const double angle = kAngle + kOffset * double(walker_.scene().radius()) / distance;
    if (!solver_.isAlong(joined->found, queryOf(z, y0), Vec3d(toChain), angle, tally)) return 0.0;
    return densityAt(y0, seenSamples, *joined);
}

bool RefractedLamps::isGlass(const PathVertex& v) const {
    return v.event == ScatterEvent::DeltaTransmission &&
           stopsAllRays(walker_.scene().description().materials[v.material]);
}

void RefractedLamps::look(std::span<PathVertex> light, RayTally& tally) const {
    if (light.empty() || !isHittable(walker_.lights().kind(light[0].light))) return;
    // A connection may end at a vertex where the walk itself went on through a layer of glass.
    for (std::size_t last = 1; last + 1 < light.size() && last <= Chain::kMost; ++last) {
        if (!isGlass(light[last])) return;
        PathVertex& z = light[last + 1];
        if (!z.connectable() || !mayBring(z)) continue;
        z.throughGlass = float(densityOfChain(z, light[0], light[last], last, z.toPrevious, tally));
    }
}

double RefractedLamps::ratioOf(const FullPath& path, RayTally& tally, bool anew) const {
    if (!path.hittable) return 0.0;
    std::size_t count = 0;
    while (int(count) + 1 < path.edges && path.delta[count + 1] &&
           isGlass(*path.vertex[count + 1])) {
        ++count;
    }
    const bool ends = int(count) + 1 == path.edges || path.delta[count + 1];
    if (count == 0 || count > Chain::kMost || ends) return 0.0;
    const Vec3 toChain = -path.directionOf(int(count));
    const PathVertex &z = *path.vertex[count + 1], &end = path.lightsEnd(int(count));
    const double density =
        !anew && path.lightEdges > int(count)
            ? double(end.throughGlass)
            : densityOfChain(end, *path.vertex[0], *path.vertex[count], count, toChain, tally);
    if (!(density > 0.0)) return 0.0;
    const Vec3 toEye = path.directionOf(int(count) + 1);
    const auto eyePdfW = double(walker_.scattering(z, toEye, toChain).pdfWToLight);
    const double samples = samplesAt(end, path.orderOf(int(count) + 1));
    return eyePdfW > 0.0 ? samples * density / eyePdfW : 0.0;
}

std::optional<Closed> RefractedLamps::sample(Subpath eye, Rng& rng, RayTally& tally,
                                             std::vector<PathVertex>& light, FullPath& path) const {
    const PathVertex& z = eye.back();
    const int left = walker_.limits().maxDepth - int(eye.size());
    if (left < 1 || z.kind != VertexKind::Surface || !z.connectable()) return std::nullopt;
    const double expected = samplesAt(z, connectionOrder(eye));
    if (rng.uniformDouble() >= expected) return std::nullopt;
    PathVertex y0;
    const double seenSamples = walker_.sampleSeenLight(z, rng, y0);
    const double samples = expected * seenSamples;
    if (!(samples > 0.0) || !isHittable(walker_.lights().kind(y0.light))) return std::nullopt;
    const auto joined = drawBetween(z, y0, rng.uniformDouble(), tally);
    if (!joined || int(joined->found.chain.size()) > left) return std::nullopt;
    auto event = closeNextEvent(walker_, joined->found, y0, eye, tally, light, path);
    if (!event) return std::nullopt;
    event->closed.contribution *= float(1.0 / (samples * joined->pmf));
    path.refracted = expected * densityAt(y0, seenSamples, *joined) / event->eyePdfW;
    return event->closed;
}

}  // namespace lacuna
