#include "libcore/bidir/specular_chains.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libcore/bidir/chain_vertices.h"

namespace lacuna {

SpecularChains::SpecularChains(const Walker& walker, std::shared_ptr<const ChainSeeds> seeds)
    : walker_(walker), search_(walker.scene()), seeds_(std::move(seeds)) {
    const Lights& lights = walker.lights();
    std::vector<double> powers;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (isHittable(lights.kind(i))) continue;
        lights_.push_back(i);
        powers.push_back(lights.powerShare(i));
    }
    byPower_ = DiscreteDistribution(powers);
}

bool SpecularChains::begin(Subpath eye, const TechniqueCounts& counts) {
    const PathVertex& z = eye.back();
    if (z.kind != VertexKind::Surface || !z.connectable()) return false;
    // The light's edges end in mirrors or glass; those of the eye's part are joined by splats, the
    // first one, or by connections with s >= 2.
    const bool connects = counts.connectsIndirect();
    const auto smooth = [&](std::size_t i) {
        return i == 0 || i + 1 == eye.size() || !isDelta(eye[i].event);
    };
    for (std::size_t i = 0; i + 1 < eye.size(); ++i) {
        const bool joined = i == 0 ? counts.splats > 0.0 : connects;
        if (joined && smooth(i) && smooth(i + 1)) return false;
    }
    return true;
}

bool SpecularChains::begin(const FullPath& path, std::size_t i, const TechniqueCounts& counts) {
    const PathVertex& z = *path.vertex[i];
    if (z.kind != VertexKind::Surface || !z.connectable()) return false;
    const bool connects = counts.connectsIndirect();
    for (std::size_t k = std::size_t(path.edges); i < k; ++i) {
        const bool joined = i + 1 == k ? counts.splats > 0.0 : connects;
        if (joined && !path.delta[i] && !path.delta[i + 1]) return false;
    }
    return true;
}

bool SpecularChains::reach(const FullPath& path) {
    if (path.hittable) return false;
    std::size_t deltas = 0;
    for (int i = 1; i < path.edges && path.delta[std::size_t(i)]; ++i) ++deltas;
    return deltas > 0 && deltas <= Chain::kMost && int(deltas) + 1 < path.edges;
}

void SpecularChains::sample(Subpath eye, Rng& rng, RayTally& tally, std::vector<PathVertex>& light,
                            FullPath& path,
                            const std::function<void(const Closed&)>& deliver) const {
    const PathVertex& z = eye.back();
    const int left = walker_.limits().maxDepth - int(eye.size());
    if (left < 1) return;
    const std::size_t most = std::min(std::size_t(left), Chain::kMost);

    const DiscreteDistribution::Pick pick = byPower_.sample(rng.uniformDouble());
    PathVertex y0;
    if (!walker_.placeLight(lights_[pick.index], pick.pmf, y0)) return;
    const ChainQuery query{
        {z.position, z.ng, scatteringSide(z)}, {y0.position, y0.infinite()}, most};
    const auto bring = [&](const FoundChain& found, const auto& repeats) {
        light.assign(1, y0);
        appendChain(walker_, found.chain, light);
        const BsdfEvaluation atEye =
            walker_.scattering(z, z.toPrevious, Vec3(found.chain.firstDirection()));
        const Rgb contribution = broughtBy(walker_, found, light, z, atEye.f);
        if (isBlack(contribution) || !isOpen(walker_, light, z, tally)) return;
        deliver(closeChain(walker_, light, eye, atEye.f, contribution * float(repeats()), path));
    };

    const WaysNearby ways = seeds_->near(y0.light, z.position, sideOfPath(z));
    const std::vector<FoundChain> usual = search_.follower().usual(query, ways, tally);
    for (const FoundChain& found : usual) bring(found, [] { return 1.0; });

    const std::optional<FoundChain> drawn = search_.draw(query, ways.all, rng, tally);
    if (!drawn || isAmong(usual, *drawn)) return;
    bring(*drawn,
          [&] { return search_.reciprocalProbability(*drawn, query, ways.all, rng, tally); });
}

}  // namespace lacuna
