// (theory.md, "Next event along known ways")
#include "libcore/bidir/known_ways.h"

#include <algorithm>
#include <cmath>

#include "libcore/bidir/chain_vertices.h"
#include "libcore/bidir/refracted_lamps.h"
#include "libcore/bidir/specular_chains.h"

namespace lacuna {

namespace {

constexpr double kAngle =
    1e-3;  // largest between the first directions of a walk's path and of its chain

/// The query for chains between z and y_0. They are functions of it alone.
ChainQuery queryOf(const PathVertex& z, const Vec3& side, const PathVertex& y0) {
    return {{z.position, z.ng, z.bsdf.transmits() ? Vec3{} : side},
            {y0.position, y0.infinite()},
            Chain::kMost};
}

/// Whether the delta event at x_i is one about the geometric normal.
bool isAboutNg(const FullPath& path, std::size_t i) {
    const PathVertex& v = *path.vertex[i];
    const Vec3 toEye = path.directionOf(int(i)), toLight = -path.directionOf(int(i) - 1);
    return v.bsdf.isAboutNg(toEye, toLight, v.event);
}

/// Whether the events at the path's vertices x_1 .. x_count are those of the way.
bool hasEventsOf(const FullPath& path, const ChainSeed& way, std::size_t count) {
    if (way.size != count) return false;
    for (std::size_t i = 0; i < count; ++i) {
        const SpecularEvent& event = way.events[i];
        if (path.vertex[count - i]->event != event.event) return false;
        // A clearcoat has normals of its own, whatever aboutNg says.
        if (!event.onClearcoat && isAboutNg(path, count - i) != event.aboutNg) return false;
    }
    return true;
}

}  // namespace

/// The upper bound of n(z). It is lower for deep vertices: there are many, and each carries little.
double KnownWays::mostSamples(int order) const {
    constexpr double kByOrder[] = {0.25, 0.125, 0.0625};
    return effort_ * kByOrder[std::min(order, 3) - 1];
}

/// n(z) over its bound. Zero where no way is near: there all is left to walks.
double KnownWays::shareOfSamples(const WaysNearby& ways) {
    constexpr double kFewest = 0.002;
    return ways.strength > 0.0 ? ways.samples(kFewest) : 0.0;
}

void KnownWays::sample(Subpath eye, const TechniqueCounts& counts, Rng& rng, RayTally& tally,
                       std::vector<PathVertex>& light, FullPath& path,
                       const std::function<void(const Closed&)>& deliver) const {
    const PathVertex& z = eye.back();
    const int left = walker_.limits().maxDepth - int(eye.size());
    if (left < 1 || !SpecularChains::begin(eye, counts)) return;
    // The bound is tried first, because ways lie anywhere in memory.
    const double most = mostSamples(connectionOrder(eye)), u = rng.uniformDouble();
    if (u >= most) return;
    const Vec3 side = sideOfPath(z);
    const WaysNearby ways = seeds_->nearOfLamps(z.position, side);
    const double expected = most * shareOfSamples(ways);
    if (u >= expected) return;
    PathVertex y0;
    const LightSampler::Seen draw = walker_.sampleSeenLight(z, rng, y0);
    const double samples = expected * draw.samples;
    if (!(samples > 0.0) || !isHittable(walker_.lights().kind(y0.light))) return;

    const ChainQuery query = queryOf(z, side, y0);
    const auto bring = [&](const FoundChain& found, bool isUsual) {
        if (int(found.chain.size()) > left) return;
        auto event = closeNextEvent(walker_, found, y0, eye, tally, light, path);
        if (!event) return;
        if (counts.refractedLamps && counts.refractedLamps->ratioOf(path, tally).ratio > 0.0)
            return;
        const std::optional<Known> known =
            isUsual ? Known{found, true, 1.0}
                    : knownOf(path, found.chain.size(), query, ways, tally);
        if (!known || known->isUsual != isUsual) return;
        event->closed.contribution *= float(draw.weight() / (expected * known->pmf));
        path.refracted = {samples * densityOf(*known, y0) / event->eyePdfW,
                          int(found.chain.size())};
        deliver(event->closed);
    };
    const std::vector<FoundChain> usual = follower_.usual(query, ways, tally);
    for (const FoundChain& found : usual) bring(found, true);
    if (ways.others.empty()) return;
    const std::uint32_t way = ways.others[rng.below(std::uint32_t(ways.others.size()))];
    const std::optional<FoundChain> drawn = follower_.followOther(ways.all[way], query, tally);
    // A usual chain would be rejected in `bring`, after some work.
    if (drawn && !isAmong(usual, *drawn)) bring(*drawn, false);
}

/// The chain of `count` vertices that the path runs through between x_0 and z, as ways lead to it; empty where none
/// does. Where two facets of a smooth surface meet, chains may lie closer together than a walk's floats can tell. Then
/// it is the nearest one.
std::optional<KnownWays::Known> KnownWays::knownOf(const FullPath& path, std::size_t count,
                                                   const ChainQuery& query, const WaysNearby& ways,
                                                   RayTally& tally) const {
    struct Led {
        bool byUsual;
        FoundChain found;
    };
    const Vec3d toChain(-path.directionOf(int(count)));
    std::vector<Led> led;
    const auto follow = [&](std::span<const std::uint32_t> some, bool areUsual) {
        for (const std::uint32_t way : some) {
            if (!hasEventsOf(path, ways.all[way], count)) continue;
            const std::optional<FoundChain> found =
                areUsual ? follower_.followUsual(ways.all[way], query, tally)
                         : follower_.followOther(ways.all[way], query, tally);
            if (found && follower_.solver().isAlong(*found, query, toChain, kAngle, tally)) {
                led.push_back({areUsual, *found});
            }
        }
    };
    follow(ways.usual, true);
    follow(ways.others, false);
    if (led.empty()) return std::nullopt;
    const auto apart = [&](const Led& l) {
        return lengthSquared(l.found.chain.firstDirection() - toChain);
    };
    const FoundChain own = std::ranges::min_element(led, {}, apart)->found;
    std::erase_if(led, [&](const Led& l) { return !isAmong({&own, 1}, l.found); });
    // The same bits as in sample(), which follows the ways in the same order. The miss that remains differs
    // from way to way.
    const auto usual = std::ranges::find_if(led, &Led::byUsual);
    if (usual != led.end()) return Known{usual->found, true, 1.0};
    return Known{own, false, double(led.size()) / double(ways.others.size())};
}

/// Density of y_0 over the chain, relative to an eye walk's without its direction's density at z.
double KnownWays::densityOf(const Known& known, const PathVertex& y0) const {
    return densityOfNextEvent(walker_, known.found, y0) * known.pmf;
}

OverChain KnownWays::ratioOf(const FullPath& path, const TechniqueCounts& counts,
                             RayTally& tally) const {
    if (!path.hittable) return {};
    const auto count = std::size_t(path.deltasBehindLight());
    if (count == 0 || count > Chain::kMost) return {};
    if (!SpecularChains::begin(path, count + 1, counts)) return {};
    const PathVertex &z = *path.vertex[count + 1], &y0 = *path.vertex[0];
    const Vec3 toChain = -path.directionOf(int(count)), toEye = path.directionOf(int(count) + 1);
    // Where pixels share walks, z's own walk may have come from elsewhere.
    const Vec3 side = sideTowards(z, toEye);
    const WaysNearby ways = seeds_->nearOfLamps(z.position, side);
    const double samples = mostSamples(path.orderOf(int(count) + 1)) * shareOfSamples(ways) *
                           walker_.seenSamples(y0, z);
    if (!(samples > 0.0)) return {};
    const auto eyePdfW = double(walker_.scattering(z, toEye, toChain).pdfWToLight);
    if (!(eyePdfW > 0.0)) return {};
    const std::optional<Known> known = knownOf(path, count, queryOf(z, side, y0), ways, tally);
    if (!known) return {};
    return {samples * densityOf(*known, y0) / eyePdfW, int(count)};
}

OverChain refractedRatioOf(const FullPath& path, const TechniqueCounts& counts, RayTally& tally,
                           bool anew) {
    OverChain over;
    if (counts.refractedLamps) over = counts.refractedLamps->ratioOf(path, tally, anew);
    if (over.ratio > 0.0 || !counts.knownWays) return over;
    return counts.knownWays->ratioOf(path, counts, tally);
}

}  // namespace lacuna
