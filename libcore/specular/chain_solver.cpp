// (theory.md, "Specular chains", "Next event through glass")
#include "libcore/specular/chain_solver.h"

#include <cmath>
#include <utility>

namespace lacuna {

namespace {

constexpr int kMostSteps = 12;        // of Newton's method, those that did not help included
constexpr double kConverged = 1e-10;  // of the miss: rounding in double
constexpr double kAccepted = 1e-6;    // of the miss, where texels of a normal map end the descent
constexpr double kAtTarget = 1e-4;  // of the whole way: what is nearer is the target's own surface
constexpr double kShortestStep = 0.1;  // of a full one

double determinantOf(const Jacobian& j) {
    return j[0][0] * j[1][1] - j[0][1] * j[1][0];
}

/// By how much the last ray misses the target: the difference of two unit directions, its two
/// coordinates across the direction to the target, and their changes by each parameter.
struct Miss {
    Vec3d by;
    std::array<double, 2> across;
    Jacobian acrossBy;
    double distance;  // to the target; 1 at infinity

    double size() const { return length(by); }
};

Miss missOf(const MovingRay& ray, const ChainTarget& target) {
    const Vec3d to = target.wayFrom(ray.origin);
    const double distance = target.infinite ? 1.0 : length(to);
    const Vec3d towards = target.infinite ? to : to * (1.0 / distance);
    Miss miss{ray.direction - towards, {}, {}, distance};
    const MovingRay axes = MovingRay::from({}, towards);
    for (std::size_t c = 0; c < 2; ++c) {
        const Vec3d& axis = axes.directionBy[c];
        miss.across[c] = dot(miss.by, axis);
        for (std::size_t i = 0; i < 2; ++i) {
            const double turned = target.infinite ? 0.0 : dot(ray.originBy[i], axis) / distance;
            miss.acrossBy[c][i] = dot(ray.directionBy[i], axis) + turned;
        }
    }
    return miss;
}

/// Newton's step: the angles that would take the miss away; at most a radian.
std::optional<std::array<double, 2>> stepOf(const Miss& miss) {
    const double determinant = determinantOf(miss.acrossBy);
    if (!(std::fabs(determinant) > 0.0)) return std::nullopt;
    const auto& [a, b] = miss.acrossBy;
    std::array<double, 2> step = {(b[1] * miss.across[0] - a[1] * miss.across[1]) / -determinant,
                                  (a[0] * miss.across[1] - b[0] * miss.across[0]) / -determinant};
    const double size = std::hypot(step[0], step[1]);
    if (!std::isfinite(size)) return std::nullopt;
    if (size > 1.0) step = {step[0] / size, step[1] / size};
    return step;
}

}  // namespace

bool onSameSideOfFold(const Jacobian& a, const Jacobian& b) {
    return (determinantOf(a) > 0.0) == (determinantOf(b) > 0.0);
}

std::optional<Hit> ChainSolver::next(const ChainStart& start, const Chain& chain,
                                     RayTally& tally) const {
    const Vec3 ng = chain.size() > 0 ? chain.lastNormal() : start.ng;
    return scene_.trace(Vec3(chain.last().origin), ng, Vec3(chain.last().direction), RayKind::Chain,
                        tally);
}

/// Replaces `chain` by the chain of the same events along another first ray. False where there is none. It stays on the
/// same triangles where it can, so that mostly no ray is traced; whether its edges are open is asked later, of what is
/// found. Facets are those of `events`, or `facets` where these are given.
bool ChainSolver::retrace(const ChainStart& start, const Vec3d& direction, const Chain& events,
                          Chain& chain, RayTally& tally, std::span<const FacetSlope> facets) const {
    chain.restart(MovingRay::from(Vec3d(start.position), direction));
    while (chain.size() < events.size()) {
        const ChainVertex& before = events[chain.size()];
        std::optional<Hit> hit = chain.meetAgain(before);
        if (!hit) hit = next(start, chain, tally);
        const FacetSlope facet = facets.empty() ? before.facet : facets[chain.size()];
        if (!hit || !chain.extend(scene_, *hit, before.event, facet)) return false;
    }
    return true;
}

std::optional<FoundChain> ChainSolver::solve(const ChainQuery& query, const Chain& seed,
                                             RayTally& tally) const {
    // Two that take turns: a chain is too large to be copied in every step.
    Chain one = seed, other(seed.first());
    Chain *chain = &one, *moved = &other;
    Miss miss = missOf(chain->last(), query.target);
    double scale = 1.0;
    for (int i = 0; i < kMostSteps && miss.size() > kConverged && scale > kShortestStep; ++i) {
        const auto step = stepOf(miss);
        if (!step) break;
        const MovingRay& first = chain->first();
        const Vec3d direction =
            normalize(first.direction + first.directionBy[0] * ((*step)[0] * scale) +
                      first.directionBy[1] * ((*step)[1] * scale));
        if (retrace(query.start, direction, *chain, *moved, tally)) {
            const Miss now = missOf(moved->last(), query.target);
            if (now.size() < miss.size()) {
                std::swap(chain, moved);
                miss = now;
                scale = std::min(1.0, 2.0 * scale);
                continue;
            }
            if (miss.size() < kAccepted) break;  // nothing but rounding is left
        }
        scale *= 0.5;
    }
    const double determinant = std::fabs(determinantOf(miss.acrossBy));
    const double spread = 1.0 / (determinant * miss.distance * miss.distance);
    if (!(miss.size() < kAccepted) || !std::isfinite(spread)) return std::nullopt;
    return FoundChain{*chain, spread, miss.acrossBy};
}

bool ChainSolver::stopsAllRaysAlong(const Chain& chain) const {
    for (std::size_t i = 0; i < chain.size(); ++i) {
        if (!stopsAllRays(scene_.description().materials[chain[i].point.material])) return false;
    }
    return true;
}

/// A ray that is refracted by all glass that it meets before the target.
struct ChainSolver::Refracted {
    Chain chain;
    std::optional<Hit> first;  // its first hit, glass or not
};

/// Extends the chain by a refraction, smooth or as if the glass were smooth.
bool ChainSolver::refractAt(const Hit& hit, Chain& chain) const {
    const bool byFacet = mayBeNarrowGlass(scene_.materialAt(hit));
    return chain.extend(
        scene_, hit, {.event = byFacet ? ScatterEvent::Smooth : ScatterEvent::DeltaTransmission});
}

ChainSolver::Refracted ChainSolver::refracted(const ChainQuery& query, const Vec3d& direction,
                                              RayTally& tally) const {
    const ChainTarget& target = query.target;
    Refracted ray{Chain(MovingRay::from(Vec3d(query.start.position), direction)), {}};
    Chain& chain = ray.chain;
    while (chain.size() < query.most) {
        const std::optional<Hit> hit = next(query.start, chain, tally);
        if (!hit) break;
        const bool behind = !target.infinite &&
                            double(hit->distance) >= length(target.wayFrom(chain.last().origin));
        if (behind) break;
        if (chain.size() == 0) ray.first = hit;
        if (!refractAt(*hit, chain)) break;
    }
    return ray;
}

std::optional<FoundChain> ChainSolver::solvedThroughGlass(const ChainQuery& query,
                                                          const Chain& chain,
                                                          RayTally& tally) const {
    if (chain.size() == 0 || !stopsAllRaysAlong(chain)) return std::nullopt;
    const auto found = solve(query, chain, tally);
    // Newton's method may have left the surfaces that it began with.
    if (!found || !stopsAllRaysAlong(found->chain)) return std::nullopt;
    const ChainTarget& target = query.target;
    if (target.infinite) return found;
    // A lamp may be of glass itself, and rounding may put its surface before the target.
    const double last = length(target.wayFrom(found->chain.last().origin));
    const double whole = length(target.wayFrom(Vec3d(query.start.position)));
    return last > kAtTarget * whole ? found : std::nullopt;
}

/// The direction from within a body that its surface, if it were flat, would refract to the target.
std::optional<Vec3d> ChainSolver::turnedToLeave(const ChainQuery& query,
                                                const Refracted& ray) const {
    if (!ray.first) return std::nullopt;
    SurfacePoint point;
    scene_.surfaceAt(*ray.first, point);
    if (!(dot(ray.chain.firstDirection(), Vec3d(point.ng)) > 0.0)) return std::nullopt;
    const Bsdf bsdf = scene_.bsdfAt(point);
    const bool refracts = bsdf.has(ScatterEvent::DeltaTransmission) || bsdf.refractsNarrowly();
    if (!refracts || !bsdf.bends()) return std::nullopt;
    const Vec3d n(point.ns);
    return refractedWay(Vec3d(query.start.position),
                        {n, dot(n, Vec3d(point.position)), double(bsdf.relativeIndex(true))},
                        query.target);
}

std::optional<FoundChain> ChainSolver::throughGlass(const ChainQuery& query, const Vec3d& direction,
                                                    RayTally& tally) const {
    const Refracted ray = refracted(query, direction, tally);
    const auto found = solvedThroughGlass(query, ray.chain, tally);
    if (found) return found;
    const auto turned = turnedToLeave(query, ray);
    if (!turned) return std::nullopt;
    return solvedThroughGlass(query, refracted(query, *turned, tally).chain, tally);
}

std::optional<FoundChain> ChainSolver::withFacets(const ChainQuery& query, const FoundChain& smooth,
                                                  std::span<const FacetSlope> facets,
                                                  RayTally& tally) const {
    Chain turned(smooth.chain.first());
    if (!retrace(query.start, turned.firstDirection(), smooth.chain, turned, tally, facets)) {
        return std::nullopt;
    }
    return solvedThroughGlass(query, turned, tally);
}

bool ChainSolver::isAlong(const FoundChain& found, const ChainQuery& query, const Vec3d& direction,
                          double angle, RayTally& tally) const {
    if (!(length(direction - found.chain.firstDirection()) < angle)) return false;
    Chain path(found.chain.first());
    return !retrace(query.start, direction, found.chain, path, tally) ||
           onSameSideOfFold(found.missBy, missOf(path.last(), query.target).acrossBy);
}

}  // namespace lacuna
