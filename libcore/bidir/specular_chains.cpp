// (theory.md, "Specular chains")
#include "libcore/bidir/specular_chains.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libcore/bidir/chain_vertices.h"

namespace lacuna {

SpecularChains::SpecularChains(const Walker& walker, std::shared_ptr<const ChainSeeds> seeds,
                               double effort)
    : walker_(walker), search_(walker.scene()), seeds_(std::move(seeds)), effort_(effort) {
    const Lights& lights = walker.lights();
    std::vector<double> powers;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (isHittable(lights.kind(i))) continue;
        lights_.push_back(i);
        powers.push_back(lights.powerShare(i));
    }
    byPower_ = DiscreteDistribution(powers);
}

namespace {

/// Whether one of the first `edges` edges from the lens could be joined: the first one by splats, others by connections
/// with s >= 2. smooth(i) says whether their i-th end scatters smoothly; end 0 is the lens.
template <class Smooth>
bool joinsAny(std::size_t edges, const TechniqueCounts& counts, const Smooth& smooth) {
    const bool connects = counts.connectsIndirect();
    for (std::size_t i = 0; i < edges; ++i) {
        const bool joined = i == 0 ? counts.splats > 0.0 : connects;
        if (joined && smooth(i) && smooth(i + 1)) return true;
    }
    return false;
}

bool mayBegin(const PathVertex& z) {
    return z.kind == VertexKind::Surface && z.connectable();
}

}  // namespace

// The edges of the chain end in mirrors or glass. So only the edges of the eye's part are tested.
bool SpecularChains::begin(Subpath eye, const TechniqueCounts& counts) {
    const std::size_t last = eye.size() - 1;
    return mayBegin(eye[last]) && !joinsAny(last, counts, [&](std::size_t i) {
               return i == 0 || i == last || !isDelta(eye[i].event);
           });
}

bool SpecularChains::begin(const FullPath& path, std::size_t i, const TechniqueCounts& counts) {
    const auto lens = std::size_t(path.edges);
    return mayBegin(*path.vertex[i]) && !joinsAny(lens - i, counts, [&](std::size_t fromLens) {
               return !path.delta[lens - fromLens];
           });
}

bool SpecularChains::reach(const FullPath& path) {
    const int deltas = path.deltasBehindLight();
    return !path.hittable && deltas > 0 && deltas <= int(Chain::kMost);
}

SpecularChains::Drawn SpecularChains::drawLight(const Vec3& place, const Vec3& side,
                                                Rng& rng) const {
    const double u = rng.uniformDouble();
    const std::span<const ChainSeeds::LightShare> ways = seeds_->lightsNear(place, side);
    double all = 0.0;
    for (const ChainSeeds::LightShare& way : ways) all += double(way.power);
    if (!(all > 0.0 && std::isfinite(all))) {
        const DiscreteDistribution::Pick pick = byPower_.sample(u);
        return {lights_[pick.index], pick.pmf};
    }
    constexpr double kByWays = 0.5;
    std::uint32_t light = ways.back().light;
    if (u < kByWays) {
        double left = u / kByWays * all;
        const auto way = std::ranges::find_if(ways, [&](const ChainSeeds::LightShare& w) {
            left -= double(w.power);
            return left < 0.0;
        });
        if (way != ways.end()) light = way->light;
    } else {
        light = lights_[byPower_.sample((u - kByWays) / (1.0 - kByWays)).index];
    }
    double known = 0.0;
    for (const ChainSeeds::LightShare& way : ways) {
        if (way.light == light) known += double(way.power);
    }
    const auto index = std::size_t(std::ranges::lower_bound(lights_, light) - lights_.begin());
    return {light, kByWays * known / all + (1.0 - kByWays) * byPower_.pmf(index)};
}

void SpecularChains::sample(Subpath eye, Rng& rng, RayTally& tally, std::vector<PathVertex>& light,
                            FullPath& path,
                            const std::function<void(const Closed&)>& deliver) const {
    const PathVertex& z = eye.back();
    const int left = walker_.limits().maxDepth - int(eye.size());
    if (left < 1) return;
    const std::size_t most = std::min(std::size_t(left), Chain::kMost);

    // A search takes longer than the rest of the path. The bound is tried first, because ways lie anywhere in memory.
    constexpr double kFewest = 0.05;
    const double u = rng.uniformDouble();
    if (u >= effort_) return;
    const Vec3 side = sideOfPath(z);
    const Drawn drawn = drawLight(z.position, side, rng);
    PathVertex y0;
    if (!walker_.placeLight(drawn.light, drawn.pmf, y0)) return;
    const WaysNearby ways = seeds_->near(y0.light, z.position, side);
    const double searches = std::min(1.0, effort_ * ways.samples(kFewest));
    if (u >= searches) return;
    const ChainQuery query{
        {z.position, z.ng, scatteringSide(z)}, {y0.position, y0.infinite()}, most};
    const auto bring = [&](const FoundChain& found, const ChainSearch::Worth& worth) {
        light.assign(1, y0);
        appendChain(walker_, found.chain, light);
        const BsdfEvaluation atEye =
            walker_.scattering(z, z.toPrevious, Vec3(found.chain.firstDirection()));
        const Rgb contribution = broughtBy(walker_, found, light, z, atEye.f);
        if (isBlack(contribution) || !isOpen(walker_, light, z, tally)) return;
        const double counts = worth() / searches;
        if (!(counts > 0.0)) return;
        deliver(closeChain(walker_, light, eye, atEye.f, contribution * float(counts), path));
    };

    search_.sample(query, ways, rng, tally, bring);
}

}  // namespace lacuna
