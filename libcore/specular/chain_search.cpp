#include "libcore/specular/chain_search.h"

#include <algorithm>
#include <cmath>

namespace lacuna {

namespace {

constexpr int kMostSteps = 12;         // of Newton's method, those that did not help included
constexpr double kConverged = 1e-10;   // of the miss: rounding in double
constexpr double kAccepted = 1e-6;     // where texels of a normal map end the descent before
constexpr double kSame = 1e-5;         // two chains, by the miss that would lie between them
constexpr double kAtTarget = 1e-4;     // of the way: what lies there is the target's own surface
constexpr double kShortestStep = 0.1;  // of a full one

double determinantOf(const Jacobian& j) {
    return j[0][0] * j[1][1] - j[0][1] * j[1][0];
}

/// By how much the last ray misses the target: the difference of two unit directions, and of it the
/// two coordinates across the target's, by each parameter.
struct Miss {
    Vec3d by;
    std::array<double, 2> across;
    Jacobian acrossBy;
    double distance;  // to the target; 1 at infinity

    double size() const { return length(by); }
};

Miss missOf(const MovingRay& ray, const ChainTarget& target) {
    const Vec3d to = target.infinite ? Vec3d(target.position) : Vec3d(target.position) - ray.origin;
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

/// Two solutions that lie close together, at a fold of a caustic, have determinants of opposite signs.
bool onSameSideOfFold(const Jacobian& a, const Jacobian& b) {
    return (determinantOf(a) > 0.0) == (determinantOf(b) > 0.0);
}

/// Whether two searches for the same target, of the same events, found the same chain.
bool same(const FoundChain& a, const FoundChain& b) {
    if (!onSameSideOfFold(a.missBy, b.missBy)) return false;
    const Vec3d apart = b.chain.firstDirection() - a.chain.firstDirection();
    const auto& axes = a.chain.first().directionBy;
    const double u = dot(apart, axes[0]), v = dot(apart, axes[1]);
    return lengthSquared(apart) < 1e-2 &&
           std::hypot(a.missBy[0][0] * u + a.missBy[0][1] * v,
                      a.missBy[1][0] * u + a.missBy[1][1] * v) < kSame;
}

}  // namespace

std::optional<Hit> ChainSearch::next(const ChainStart& start, const Chain& chain,
                                     RayTally& tally) const {
    const Vec3 ng = chain.size() > 0 ? chain.lastNormal() : start.ng;
    return scene_.trace(Vec3(chain.last().origin), ng, Vec3(chain.last().direction), RayKind::Chain,
                        tally);
}

/// A third of the rays each: straight to the light, since glass before it turns rays a little; to the
/// surfaces where chains may begin, wherever they are; and to what the start sees, so that what is near
/// is found as well.
Vec3d ChainSearch::seedDirection(const ChainQuery& query, Rng& rng) const {
    const ChainStart& start = query.start;
    const ChainTarget& target = query.target;
    const std::uint32_t way = rng.below(3);
    if (way == 0) {
        return target.infinite ? Vec3d(target.position)
                               : normalize(Vec3d(target.position) - Vec3d(start.position));
    }
    if (way == 1) {
        return normalize(Vec3d(triangles_.samplePoint(rng)) - Vec3d(start.position));
    }
    const float u1 = rng.uniform(), u2 = rng.uniform();
    const bool otherSide = rng.uniform() < 0.5f;
    Vec3 normal = start.side;
    if (normal == Vec3{}) normal = otherSide ? -start.ng : start.ng;
    return normalize(Vec3d(Frame(normal).toWorld(cosineHemisphere(u1, u2))));
}

/// A ray that scatters by the events' shares, from where it leads to specular surfaces. It may end at
/// any vertex, and more seldom where another one follows, which then stands before the light.
std::optional<Chain> ChainSearch::seed(const ChainQuery& query, Rng& rng, RayTally& tally) const {
    const ChainStart& start = query.start;
    constexpr float kEndsBefore = 0.1f;
    const Vec3d direction = seedDirection(query, rng);
    if (!(lengthSquared(direction) > 0.0)) return std::nullopt;
    Chain chain(MovingRay::from(Vec3d(start.position), direction));
    while (chain.size() < query.most) {
        const std::optional<Hit> hit = next(start, chain, tally);
        if (!hit) break;
        if (chain.size() > 0 && rng.uniform() < kEndsBefore) break;
        if (!chain.extend(scene_, *hit, rng.uniformDouble())) break;
    }
    if (chain.size() == 0) return std::nullopt;
    return chain;
}

/// The chain of the same events along another first ray. It stays on the same triangles where it can:
/// mostly so, without tracing rays. Whether it sees its way is asked of what is found.
std::optional<Chain> ChainSearch::retrace(const ChainStart& start, const Vec3d& direction,
                                          const Chain& events, RayTally& tally) const {
    Chain chain(MovingRay::from(Vec3d(start.position), direction));
    while (chain.size() < events.size()) {
        const ChainVertex& before = events[chain.size()];
        std::optional<Hit> hit = chain.meetAgain(before);
        if (!hit) hit = next(start, chain, tally);
        if (!hit || !chain.extend(scene_, *hit, before.event)) return std::nullopt;
    }
    return chain;
}

std::optional<FoundChain> ChainSearch::solve(const ChainQuery& query, const Chain& seed,
                                             RayTally& tally) const {
    Chain chain = seed;
    Miss miss = missOf(chain.last(), query.target);
    double scale = 1.0;
    for (int i = 0; i < kMostSteps && miss.size() > kConverged && scale > kShortestStep; ++i) {
        const auto step = stepOf(miss);
        if (!step) break;
        const MovingRay& first = chain.first();
        const Vec3d direction =
            normalize(first.direction + first.directionBy[0] * ((*step)[0] * scale) +
                      first.directionBy[1] * ((*step)[1] * scale));
        const std::optional<Chain> moved = retrace(query.start, direction, chain, tally);
        if (moved) {
            const Miss now = missOf(moved->last(), query.target);
            if (now.size() < miss.size()) {
                chain = *moved;
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
    return FoundChain{chain, spread, miss.acrossBy};
}

std::optional<FoundChain> ChainSearch::draw(const ChainQuery& query, Rng& rng,
                                            RayTally& tally) const {
    const std::optional<Chain> from = seed(query, rng, tally);
    return from ? solve(query, *from, tally) : std::nullopt;
}

bool ChainSearch::mayBeThroughGlass(std::uint32_t index) const {
    const Material& material = scene_.description().materials[index];
    return !material.pane && material.alphaMode == Material::Alpha::Opaque;
}

std::optional<FoundChain> ChainSearch::throughGlass(const ChainQuery& query,
                                                    RayTally& tally) const {
    const ChainStart& start = query.start;
    const ChainTarget& target = query.target;
    const Vec3d way = Vec3d(target.position) - (target.infinite ? Vec3d{} : Vec3d(start.position));
    if (!(lengthSquared(way) > 0.0)) return std::nullopt;
    Chain chain(MovingRay::from(Vec3d(start.position), normalize(way)));
    while (chain.size() < query.most) {
        const std::optional<Hit> hit = next(start, chain, tally);
        if (!hit) break;
        if (!target.infinite) {
            const Vec3d left = Vec3d(target.position) - chain.last().origin;
            if (double(hit->distance) >= length(left)) break;
        }
        if (!chain.extend(scene_, *hit, {.event = ScatterEvent::DeltaTransmission})) break;
        if (!mayBeThroughGlass(chain[chain.size() - 1].point.material)) return std::nullopt;
    }
    if (chain.size() == 0) return std::nullopt;
    const auto found = solve(query, chain, tally);
    if (!found || target.infinite) return found;
    // A lamp may be of glass itself, and rounding put its surface before it.
    const Vec3d last = Vec3d(target.position) - found->chain.last().origin;
    if (!(length(last) > kAtTarget * length(way))) return std::nullopt;
    return found;
}

bool ChainSearch::isAlong(const FoundChain& found, const ChainQuery& query, const Vec3d& direction,
                          double angle, RayTally& tally) const {
    if (!(length(direction - found.chain.firstDirection()) < angle)) return false;
    const std::optional<Chain> path = retrace(query.start, direction, found.chain, tally);
    return !path || onSameSideOfFold(found.missBy, missOf(path->last(), query.target).acrossBy);
}

double ChainSearch::reciprocalProbability(const FoundChain& found, const ChainQuery& query,
                                          Rng& rng, RayTally& tally) const {
    // 1 / p = sum over n >= 0 of (1 - p)^n: how often n searches in a row find something else. From
    // kAll on a roulette at each doubling, so that no single estimate takes minutes.
    constexpr std::uint64_t kAll = 1024;
    double sum = 1.0, worth = 1.0;
    for (std::uint64_t n = 1;; ++n) {
        const std::optional<Chain> from = seed(query, rng, tally);
        // Newton's method keeps the events.
        if (from && from->sameEventsAs(found.chain)) {
            const std::optional<FoundChain> again = solve(query, *from, tally);
            if (again && same(found, *again)) return sum;
        }
        if (n >= kAll && (n & (n - 1)) == 0) {
            if (rng.uniform() < 0.5f) return sum;
            worth *= 2.0;
        }
        sum += worth;
    }
}

}  // namespace lacuna
