#include "libcore/specular/chain_search.h"

#include <algorithm>
#include <cmath>

namespace lacuna {

namespace {

constexpr double kSame = 1e-5;  // two chains, by the miss that would lie between them

/// Whether two searches for the same target found the same chain.
bool isSame(const FoundChain& a, const FoundChain& b) {
    if (!a.chain.sameEventsAs(b.chain) || !onSameSideOfFold(a.missBy, b.missBy)) return false;
    const Vec3d apart = b.chain.firstDirection() - a.chain.firstDirection();
    const auto& axes = a.chain.first().directionBy;
    const double u = dot(apart, axes[0]), v = dot(apart, axes[1]);
    return lengthSquared(apart) < 1e-2 &&
           std::hypot(a.missBy[0][0] * u + a.missBy[0][1] * v,
                      a.missBy[1][0] * u + a.missBy[1][1] * v) < kSame;
}

}  // namespace

bool isAmong(std::span<const FoundChain> chains, const FoundChain& found) {
    return std::ranges::any_of(chains, [&](const FoundChain& c) { return isSame(c, found); });
}

/// A third of the rays each: straight to the light, since glass before it turns rays a little; to the
/// surfaces where chains may begin, wherever they are; and to what the start sees, so that what is near
/// is found as well.
Vec3d ChainSearch::seedDirection(const ChainQuery& query, Rng& rng) const {
    const ChainStart& start = query.start;
    const std::uint32_t way = rng.below(3);
    if (way == 0) {
        const Vec3d straight = query.target.wayFrom(Vec3d(start.position));
        return query.target.infinite ? straight : normalize(straight);
    }
    if (way == 1) {
        return normalize(Vec3d(triangles_.sample(rng).position) - Vec3d(start.position));
    }
    const float u1 = rng.uniform(), u2 = rng.uniform();
    const bool otherSide = rng.uniform() < 0.5f;
    Vec3 normal = start.side;
    if (normal == Vec3{}) normal = otherSide ? -start.ng : start.ng;
    return normalize(Vec3d(Frame(normal).toWorld(cosineHemisphere(u1, u2))));
}

/// A ray that scatters by the events' shares, from where it leads to specular surfaces. It may end at
/// any vertex, and more seldom where another one follows, which then stands before the light.
std::optional<Chain> ChainSearch::guess(const ChainQuery& query, Rng& rng, RayTally& tally) const {
    const ChainStart& start = query.start;
    constexpr float kEndsBefore = 0.1f;
    const Vec3d direction = seedDirection(query, rng);
    if (!(lengthSquared(direction) > 0.0)) return std::nullopt;
    Chain chain(MovingRay::from(Vec3d(start.position), direction));
    while (chain.size() < query.most) {
        const std::optional<Hit> hit = follower_.solver().next(start, chain, tally);
        if (!hit) break;
        if (chain.size() > 0 && rng.uniform() < kEndsBefore) break;
        if (!chain.extend(follower_.solver().scene(), *hit, rng.uniformDouble())) break;
    }
    if (chain.size() == 0) return std::nullopt;
    return chain;
}

/// The way that light came to a place nearby: to the same first vertex, or, where that is nearer than the
/// place, along the same direction.
std::optional<Chain> WayFollower::along(const ChainSeed& way, const ChainQuery& query,
                                        RayTally& tally) const {
    if (way.size > query.most) return std::nullopt;
    const Vec3d place(query.start.position), end(way.end), first(way.towards);
    const Vec3d fromEnd = first - end, fromPlace = first - place;
    const Vec3d to = lengthSquared(place - end) < lengthSquared(fromEnd) ? fromPlace : fromEnd;
    if (!(lengthSquared(to) > 0.0)) return std::nullopt;
    Chain chain(MovingRay::from(place, normalize(to)));
    while (chain.size() < way.size) {
        const std::optional<Hit> hit = solver_.next(query.start, chain, tally);
        if (!hit || !chain.extend(solver_.scene(), *hit, way.events[chain.size()])) {
            return std::nullopt;
        }
    }
    return chain;
}

std::optional<Chain> ChainSearch::seed(const ChainQuery& query, std::span<const ChainSeed> known,
                                       Rng& rng, RayTally& tally) const {
    constexpr float kKnown = 2.0f / 3;
    if (known.empty() || rng.uniform() >= kKnown) return guess(query, rng, tally);
    return follower_.along(known[rng.below(std::uint32_t(known.size()))], query, tally);
}

std::optional<FoundChain> WayFollower::follow(const ChainSeed& way, const ChainQuery& query,
                                              RayTally& tally) const {
    const std::optional<Chain> from = along(way, query, tally);
    return from ? solver_.solve(query, *from, tally) : std::nullopt;
}

std::vector<FoundChain> WayFollower::usual(const ChainQuery& query, const WaysNearby& ways,
                                           RayTally& tally) const {
    std::vector<FoundChain> chains;
    chains.reserve(ways.kinds.size());
    for (const std::uint8_t kind : ways.kinds) {
        const auto found = follow(ways.all[kind], query, tally);
        if (found && !isAmong(chains, *found)) chains.push_back(*found);
    }
    return chains;
}

std::optional<FoundChain> ChainSearch::draw(const ChainQuery& query,
                                            std::span<const ChainSeed> known, Rng& rng,
                                            RayTally& tally) const {
    const std::optional<Chain> from = seed(query, known, rng, tally);
    return from ? follower_.solver().solve(query, *from, tally) : std::nullopt;
}

double ChainSearch::reciprocalProbability(const FoundChain& found, const ChainQuery& query,
                                          std::span<const ChainSeed> known, Rng& rng,
                                          RayTally& tally) const {
    // 1 / p = sum over n >= 0 of (1 - p)^n: how often n searches in a row find something else. From
    // kAll on a roulette at each doubling, so that no single estimate takes minutes.
    constexpr std::uint64_t kAll = 1024;
    double sum = 1.0, worth = 1.0;
    for (std::uint64_t n = 1;; ++n) {
        const std::optional<Chain> from = seed(query, known, rng, tally);
        // Newton's method keeps the events.
        if (from && from->sameEventsAs(found.chain)) {
            const std::optional<FoundChain> again = follower_.solver().solve(query, *from, tally);
            if (again && isSame(found, *again)) return sum;
        }
        if (n >= kAll && (n & (n - 1)) == 0) {
            if (rng.uniform() < 0.5f) return sum;
            worth *= 2.0;
        }
        sum += worth;
    }
}

}  // namespace lacuna
