// Paths that no edge can be joined on, from lights that no ray can hit: light, mirrors and smooth glass, a
// surface, mirrors and smooth glass, the eye. They have a technique of their own and, since no other one
// makes them, the weight one. (theory.md, "Specular chains")
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "libcore/base/discrete.h"
#include "libcore/bidir/close.h"
#include "libcore/specular/chain_search.h"

namespace lacuna {

class SpecularChains {
  public:
    /// `walker` must outlive it. `seeds`: of its scene. `effort`: GlassEffort::chains.
    SpecularChains(const Walker& walker, std::shared_ptr<const ChainSeeds> seeds, double effort);

    /// The scene has no such light, or nothing that a chain could be made of.
    bool empty() const { return byPower_.empty() || search_.empty(); }

    /// Whether chains begin at an eye subpath's last vertex, z_0 .. z_{t-1}, t >= 2: none of the
    /// techniques that `counts` tells of could join an edge of a path that goes on from there through
    /// a chain.
    static bool begin(Subpath eye, const TechniqueCounts& counts);
    /// The same of x_i on a full path, i < edges.
    static bool begin(const FullPath& path, std::size_t i, const TechniqueCounts& counts);

    /// Whether a path that no edge can be joined on ends in a chain to its light that sample() finds.
    static bool reach(const FullPath& path);

    /// Paths through chains to one light, mostly none: E of them all is the light of all chains of up to
    /// Chain::kMost vertices. For each, fills `light`, y_0 .. y_{s-1} with a delta event at each but y_0, and `path`,
    /// and calls `deliver`.
    void sample(Subpath eye, Rng& rng, RayTally& tally, std::vector<PathVertex>& light,
                FullPath& path, const std::function<void(const Closed&)>& deliver) const;

  private:
    struct Drawn {
        std::uint32_t light;
        double pmf;
    };
    /// By power, and by what is known to come to the place.
    Drawn drawLight(const Vec3& place, const Vec3& side, Rng& rng) const;

    const Walker& walker_;
    ChainSearch search_;
    std::vector<std::uint32_t> lights_;  ///< without an extent
    DiscreteDistribution byPower_;       ///< over lights_
    std::shared_ptr<const ChainSeeds> seeds_;
    double effort_;
};

}  // namespace lacuna
