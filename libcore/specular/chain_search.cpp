// (theory.md, "Specular chains")
#include "libcore/specular/chain_search.h"

#include <algorithm>
#include <cmath>

namespace lacuna {

namespace {

constexpr double kSame = 1e-5;  // largest miss between two chains that count as the same

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

/// The direction of a guess. A third of the rays each go straight to the light, since glass before it turns rays a
/// little; to the surfaces where chains may begin, wherever they are; and to what the start sees, so that what is near
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

/// The chain of a random ray, whose events are drawn by their shares. It may end at any vertex. Where another surface
/// follows, which then stands before the light, it ends with the probability kEndsBefore.
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

std::optional<FoundChain> WayFollower::follow(const ChainSeed& way, const Vec3d& direction,
                                              const ChainQuery& query, RayTally& tally) const {
    Chain chain(MovingRay::from(Vec3d(query.start.position), direction));
    while (chain.size() < way.size) {
        const std::optional<Hit> hit = solver_.next(query.start, chain, tally);
        if (!hit || !chain.extend(solver_.scene(), *hit, way.events[chain.size()])) {
            return std::nullopt;
        }
    }
    return solver_.solve(query, chain, tally);
}

std::optional<FoundChain> WayFollower::followUsual(const ChainSeed& way, const ChainQuery& query,
                                                   RayTally& tally) const {
    if (way.size > query.most) return std::nullopt;
    return follow(way, way.directionAt(Vec3d(query.start.position)), query, tally);
}

/// Near a focus the way's derivative leads astray. Then the way is followed towards
/// its first vertex.
std::optional<FoundChain> WayFollower::followOther(const ChainSeed& way, const ChainQuery& query,
                                                   RayTally& tally) const {
    if (const auto found = followUsual(way, query, tally)) return found;
    const Vec3d vertex = Vec3d(way.end) + Vec3d(way.direction) * double(way.distance);
    const Vec3d to = vertex - Vec3d(query.start.position);
    if (way.size > query.most || !(lengthSquared(to) > 0.0)) return std::nullopt;
    return follow(way, normalize(to), query, tally);
}

std::vector<FoundChain> WayFollower::usual(const ChainQuery& query, const WaysNearby& ways,
                                           RayTally& tally) const {
    std::vector<FoundChain> chains;
    chains.reserve(ways.usual.size());
    for (const std::uint32_t way : ways.usual) {
        const auto found = followUsual(ways.all[way], query, tally);
        if (found && !isAmong(chains, *found)) chains.push_back(*found);
    }
    return chains;
}

std::size_t WayFollower::othersThatLeadTo(const FoundChain& found, const ChainQuery& query,
                                          const WaysNearby& ways, RayTally& tally) const {
    return std::size_t(std::ranges::count_if(ways.others, [&](std::uint32_t way) {
        if (!ways.all[way].hasEventsOf(found.chain)) return false;
        const std::optional<FoundChain> led = followOther(ways.all[way], query, tally);
        return led && isSame(*led, found);
    }));
}

/// Brings the usual chains, and one more: a chain that another way leads to, or one from a random ray if no
/// way leads to it.
void ChainSearch::sample(const ChainQuery& query, const WaysNearby& ways, Rng& rng, RayTally& tally,
                         const std::function<void(const FoundChain&, const Worth&)>& bring) const {
    const std::vector<FoundChain> usual = follower_.usual(query, ways, tally);
    for (const FoundChain& found : usual) bring(found, [] { return 1.0; });

    const auto others = double(ways.others.size());
    const double byOther = others > 0.0 ? 2.0 / 3 : 0.0;
    if (rng.uniformDouble() < byOther) {
        const std::uint32_t way = ways.others[rng.below(std::uint32_t(ways.others.size()))];
        const std::optional<FoundChain> led = follower_.followOther(ways.all[way], query, tally);
        if (!led || isAmong(usual, *led)) return;
        bring(*led, [&] {
            const std::size_t leading = follower_.othersThatLeadTo(*led, query, ways, tally);
            return others / (byOther * double(leading));
        });
        return;
    }
    const std::optional<Chain> from = guess(query, rng, tally);
    const auto found = from ? follower_.solver().solve(query, *from, tally) : std::nullopt;
    if (!found || isAmong(usual, *found)) return;
    bring(*found, [&] {
        if (follower_.othersThatLeadTo(*found, query, ways, tally) > 0) return 0.0;
        return reciprocalProbability(*found, query, rng, tally) / (1.0 - byOther);
    });
}

/// An unbiased estimate of one over the probability that a guess finds the chain. It has no upper bound. The mean
/// number of guesses is that number, too.
double ChainSearch::reciprocalProbability(const FoundChain& found, const ChainQuery& query,
                                          Rng& rng, RayTally& tally) const {
    // 1 / p = sum over n >= 0 of (1 - p)^n: its terms are the probabilities that n guesses in a row
    // find something else. From kAll on roulette is played at each doubling, so that no single
    // estimate takes minutes.
    constexpr std::uint64_t kAll = 1024;
    double sum = 1.0, worth = 1.0;
    for (std::uint64_t n = 1;; ++n) {
        const std::optional<Chain> from = guess(query, rng, tally);
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
