// (theory.md, "Next event through glass")
#include "libcore/bidir/refracted_lamps.h"

#include <algorithm>

#include "libcore/bidir/chain_vertices.h"

namespace lacuna {

namespace {

/// Largest differences between a walk's path and the chain in double between the same ends: the angle of their first
/// directions, and the offset of rays from surfaces in terms of the scene's radius.
constexpr double kAngle = 1e-3, kOffset = 1e-5;

/// The query for chains between z and y_0. They are functions of it, and of facets.
ChainQuery queryOf(const PathVertex& z, const PathVertex& y0) {
    return {{z.position, z.ng, {}}, {y0.position, y0.infinite()}, Chain::kMost};
}

bool hasFacets(const Chain& chain) {
    for (std::size_t i = 0; i < chain.size(); ++i) {
        if (!isDelta(chain[i].event.event)) return true;
    }
    return false;
}

}  // namespace

/// The facets' slopes at the chain's vertices. At smooth glass the slope is zero.
class RefractedLamps::Facets {
  public:
    /// Adds the facet of a path that is refracted at v. Vertices come in order from the light's
    /// end. False where the facet is too steep.
    bool add(const PathVertex& v, bool delta, const Vec3& toEye, const Vec3& toLight) {
        const auto facet = delta ? FacetSlope{} : facetBetween(v.bsdf, toEye, toLight);
        if (facet) add(*facet);
        return facet.has_value();
    }
    void draw(std::size_t count, Rng& rng) {
        for (size_ = 0; size_ < count;) {
            const double u = rng.uniformDouble();
            add(sampleFacet(u, rng.uniformDouble()));
        }
    }
    std::size_t size() const { return size_; }
    /// In order from the eye's end.
    std::span<const FacetSlope> inOrder() const { return std::span(facets_).last(size_); }

  private:
    void add(const FacetSlope& facet) { facets_[Chain::kMost - ++size_] = facet; }

    std::array<FacetSlope, Chain::kMost> facets_;
    std::size_t size_ = 0;
};

/// Deep vertices have fewer samples: there are many of them, and each carries little.
double RefractedLamps::samplesAt(const PathVertex& z, int order) const {
    constexpr double kByOrder[] = {1.0, 0.5, 0.25};
    return effort_ * kByOrder[std::min(order, 3) - 1] * glass_->shadows().triesAt(z.position);
}

/// The one chain that the straight ray leads to or, from within glass, a guess. It is a function of the two ends,
/// whichever walk made z. No ray is traced where the lamp lies behind z or no glass lies between.
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

/// The chain that leaves the body around z by the face of `way`, one of `ways`.
std::optional<RefractedLamps::Joined> RefractedLamps::out(const GlassBodies::WaysOut& ways,
                                                          const GlassBodies::WayOut& way,
                                                          const PathVertex& z, const PathVertex& y0,
                                                          RayTally& tally) const {
    if (!z.bsdf.transmits() && leadsBehind(z, Vec3(way.direction))) return std::nullopt;
    auto found = solver_.throughGlass(queryOf(z, y0), way.direction, tally);
    if (!found || ways.through(found->chain[0].point.ng) != &way) return std::nullopt;
    return Joined{*found, 1.0 / double(ways.size())};
}

/// One of the chains between z and y_0, drawn by `u`. Empty where Newton's method does not find it.
std::optional<RefractedLamps::Joined> RefractedLamps::drawBetween(const PathVertex& z,
                                                                  const PathVertex& y0, double u,
                                                                  RayTally& tally) const {
    const GlassBodies::WaysOut ways = glass_->bodies().waysOut(z.position, queryOf(z, y0).target);
    if (ways.size() == 0) return straight(z, y0, tally);
    const auto i = std::min(ways.size() - 1, std::size_t(u * double(ways.size())));
    return out(ways, ways[i], z, y0, tally);
}

/// The chain between z and y_0 whose first vertex, from z, is on a face with this normal.
std::optional<RefractedLamps::Joined> RefractedLamps::betweenOver(const Vec3& normal,
                                                                  const PathVertex& z,
                                                                  const PathVertex& y0,
                                                                  RayTally& tally) const {
    const GlassBodies::WaysOut ways = glass_->bodies().waysOut(z.position, queryOf(z, y0).target);
    if (ways.size() == 0) return straight(z, y0, tally);
    const GlassBodies::WayOut* way = ways.through(normal);
    return way ? out(ways, *way, z, y0, tally) : std::nullopt;
}

/// The chain that `smooth` becomes with these facets. It must leave the body around z by
/// the same face.
std::optional<RefractedLamps::Joined> RefractedLamps::turned(const Joined& smooth,
                                                             const Facets& facets,
                                                             const PathVertex& z,
                                                             const PathVertex& y0,
                                                             RayTally& tally) const {
    const Chain& chain = smooth.found.chain;
    if (!hasFacets(chain)) return smooth;
    auto found = solver_.withFacets(queryOf(z, y0), smooth.found, facets.inOrder(), tally);
    if (!found) return std::nullopt;
    const GlassBodies::WaysOut ways = glass_->bodies().waysOut(z.position, queryOf(z, y0).target);
    if (ways.through(found->chain[0].point.ng) != ways.through(chain[0].point.ng)) {
        return std::nullopt;
    }
    return Joined{*found, smooth.pmf};
}

/// Density of y_0 over this chain, relative to an eye walk's as in densityOfNextEvent.
double RefractedLamps::densityAt(const PathVertex& y0, double seenSamples,
                                 const Joined& joined) const {
    return densityOfNextEvent(walker_, joined.found, y0) * seenSamples * joined.pmf;
}

/// densityAt for a path through these facets, from the smooth chain between its ends. `last` is the path's vertex next
/// to z. Zero where the facets lead to another chain.
double RefractedLamps::densityOver(const Joined& smooth, double seenSamples, const PathVertex& z,
                                   const PathVertex& y0, const PathVertex& last,
                                   const Facets& facets, const Vec3& toChain,
                                   RayTally& tally) const {
    if (smooth.found.chain.size() != facets.size()) return 0.0;
    const auto joined = turned(smooth, facets, z, y0, tally);
    if (!joined) return 0.0;
    const double distance = length(Vec3d(last.position) - Vec3d(z.position));
    const double angle = kAngle + kOffset * double(walker_.scene().radius()) / distance;
    if (!solver_.isAlong(joined->found, queryOf(z, y0), Vec3d(toChain), angle, tally)) return 0.0;
    return densityAt(y0, seenSamples, *joined);
}

/// Likewise where the smooth chain is not known yet.
double RefractedLamps::densityOfChain(const PathVertex& z, const PathVertex& y0,
                                      const PathVertex& last, const Facets& facets,
                                      const Vec3& toChain, RayTally& tally) const {
    const double seenSamples = walker_.seenSamples(y0, z);
    if (!(seenSamples > 0.0)) return 0.0;
    const auto smooth = betweenOver(last.ng, z, y0, tally);
    if (!smooth) return 0.0;
    return densityOver(*smooth, seenSamples, z, y0, last, facets, toChain, tally);
}

/// Whether a path with these directions at v is refracted there, by a smooth surface or by a facet.
bool RefractedLamps::refracts(const PathVertex& v, bool delta, const Vec3& toEye,
                              const Vec3& toLight) const {
    if (v.kind != VertexKind::Surface) return false;
    const Material& material = walker_.scene().description().materials[v.material];
    if (!stopsAllRays(material)) return false;
    if (delta) return v.event == ScatterEvent::DeltaTransmission;
    return glass_->hasFacets() && v.bsdf.refractsNarrowly() && mayBeNarrowGlass(material) &&
           dot(toEye, v.ng) * dot(toLight, v.ng) < 0.0f;
}

/// Whether next event may reach this light. `byFacet` says that the vertex next to the light refracts by a facet; else
/// it is smooth. Over smooth surfaces, lights without a size are left to searches for chains, or are missing.
bool RefractedLamps::mayReach(std::uint32_t light, bool byFacet) const {
    return byFacet ? glass_->hasFacets() : isHittable(walker_.lights().kind(light));
}

void RefractedLamps::look(std::span<PathVertex> light, RayTally& tally) const {
    if (light.size() < 2 || !mayReach(light[0].light, !isDelta(light[1].event))) return;
    // A connection may end at a vertex where the walk itself went on through a layer of glass.
    Facets facets;
    for (std::size_t last = 1; last + 1 < light.size() && last <= Chain::kMost; ++last) {
        const PathVertex& v = light[last];
        PathVertex& z = light[last + 1];
        const Vec3 toEye = -z.toPrevious;
        if (!refracts(v, isDelta(v.event), toEye, v.toPrevious)) return;
        if (!facets.add(v, isDelta(v.event), toEye, v.toPrevious)) return;
        if (!z.connectable() || !mayBring(z)) continue;
        z.throughGlass = float(densityOfChain(z, light[0], v, facets, z.toPrevious, tally));
    }
}

/// The facets of a path that is refracted at all vertices between its light and z. Empty where next
/// event through glass does not make such a path.
std::optional<RefractedLamps::Facets> RefractedLamps::facetsOf(const FullPath& path) const {
    if (path.edges < 2 || !mayReach(path.vertex[0]->light, !path.delta[1])) return std::nullopt;
    Facets facets;
    int i = 1;
    for (; i < path.edges; ++i) {
        const PathVertex& v = *path.vertex[std::size_t(i)];
        const bool delta = path.delta[std::size_t(i)];
        const Vec3 toEye = path.directionOf(i), toLight = -path.directionOf(i - 1);
        if (!refracts(v, delta, toEye, toLight)) break;
        if (facets.size() == Chain::kMost) return std::nullopt;
        if (!facets.add(v, delta, toEye, toLight)) return std::nullopt;
    }
    const bool ends = i == path.edges || path.delta[std::size_t(i)];
    if (facets.size() == 0 || ends) return std::nullopt;
    return facets;
}

/// FullPath::refracted, from the chain's density.
OverChain RefractedLamps::ratioBy(const FullPath& path, int vertices, double density) const {
    if (!(density > 0.0)) return {};
    const PathVertex& z = *path.vertex[std::size_t(vertices) + 1];
    const Vec3 toEye = path.directionOf(vertices + 1), toChain = -path.directionOf(vertices);
    const auto eyePdfW = double(walker_.scattering(z, toEye, toChain).pdfWToLight);
    const double samples = samplesAt(path.lightsEnd(vertices), path.orderOf(vertices + 1));
    if (!(eyePdfW > 0.0)) return {};
    return {samples * density / eyePdfW, vertices};
}

OverChain RefractedLamps::ratioOf(const FullPath& path, RayTally& tally, bool anew) const {
    const auto facets = facetsOf(path);
    if (!facets) return {};
    const auto count = int(facets->size());
    const PathVertex& end = path.lightsEnd(count);
    const double density = !anew && path.lightEdges > count
                               ? double(end.throughGlass)
                               : densityOfChain(end, *path.vertex[0], *path.vertex[facets->size()],
                                                *facets, -path.directionOf(count), tally);
    return ratioBy(path, count, density);
}

std::optional<Closed> RefractedLamps::sample(Subpath eye, Rng& rng, RayTally& tally,
                                             std::vector<PathVertex>& light, FullPath& path) const {
    const PathVertex& z = eye.back();
    const int left = walker_.limits().maxDepth - int(eye.size());
    if (left < 1 || z.kind != VertexKind::Surface || !z.connectable()) return std::nullopt;
    const double expected = samplesAt(z, connectionOrder(eye));
    if (rng.uniformDouble() >= expected) return std::nullopt;
    PathVertex y0;
    const LightSampler::Seen draw = walker_.sampleSeenLight(z, rng, y0);
    if (!(draw.samples > 0.0) || !mayReach(y0.light, glass_->hasFacets())) return std::nullopt;
    const auto smooth = drawBetween(z, y0, rng.uniformDouble(), tally);
    if (!smooth || int(smooth->found.chain.size()) > left) return std::nullopt;
    Facets facets;
    if (glass_->hasFacets()) facets.draw(smooth->found.chain.size(), rng);
    const auto joined = turned(*smooth, facets, z, y0, tally);
    if (!joined) return std::nullopt;
    const Chain& chain = joined->found.chain;
    if (!mayReach(y0.light, !isDelta(chain[chain.size() - 1].event.event))) return std::nullopt;
    // A path that is refracted at z itself belongs to a longer chain.
    if (refracts(z, false, z.toPrevious, Vec3(chain.firstDirection()))) return std::nullopt;
    auto event = closeNextEvent(walker_, joined->found, y0, eye, tally, light, path);
    if (!event) return std::nullopt;
    event->closed.contribution *= float(draw.weight() / (expected * joined->pmf));
    if (hasFacets(chain)) {
        // The ratio as other techniques compute it: with facets from the path's
        // directions in float.
        const auto known = facetsOf(path);
        if (!known) return std::nullopt;
        const std::size_t count = known->size();
        path.refracted = ratioBy(path, int(count),
                                 densityOver(*smooth, draw.samples, z, y0, *path.vertex[count],
                                             *known, -path.directionOf(int(count)), tally));
        if (!(path.refracted.ratio > 0.0)) return std::nullopt;
    } else {
        path.refracted = {expected * densityAt(y0, draw.samples, *joined) / event->eyePdfW,
                          int(chain.size())};
    }
    return event->closed;
}

}  // namespace lacuna
