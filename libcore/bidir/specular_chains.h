// Paths without an edge that a connection could join, from lights that no ray can hit: light, mirrors and smooth glass,
// a surface, mirrors and smooth glass, the eye. They have a technique of their own. No other technique makes them, so
// their weight is one. (theory.md, "Specular chains")
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
    /// `walker` must outlive this object. `seeds` are those of its scene. `effort` is
    /// GlassEffort::chains.
    SpecularChains(const Walker& walker, std::shared_ptr<const ChainSeeds> seeds, double effort);

    /// Whether the scene has no such light, or nothing that a chain could be made of.
    bool empty() const { return byPower_.empty() || search_.empty(); }

    /// Whether chains begin at the last vertex of an eye subpath z_0 .. z_{t-1}, t >= 2. They do if no technique of
    /// `counts` could join an edge of a path that goes on from there through a chain.
    static bool begin(Subpath eye, const TechniqueCounts& counts);
    /// The same for x_i of a full path, i < edges.
    static bool begin(const FullPath& path, std::size_t i, const TechniqueCounts& counts);

    /// Whether a path without an edge to join goes to its light through a chain that sample() can find.
    static bool reach(const FullPath& path);

    /// Samples paths through chains to one light; mostly there are none. The expectation of their sum is the light of
    /// all chains of up to Chain::kMost vertices. For each path it fills `path` and `light` (y_0 .. y_{s-1}, with a
    /// delta event at each but y_0), and calls `deliver`.
    void sample(Subpath eye, Rng& rng, RayTally& tally, std::vector<PathVertex>& light,
                FullPath& path, const std::function<void(const Closed&)>& deliver) const;

  private:
    struct Drawn {
        std::uint32_t light;
        double pmf;
    };
    /// Draws a light by power or by what is known to come to the place, half of the time each.
    Drawn drawLight(const Vec3& place, const Vec3& side, Rng& rng) const;

    const Walker& walker_;
    ChainSearch search_;
    std::vector<std::uint32_t> lights_;  ///< without an extent
    DiscreteDistribution byPower_;       ///< over lights_
    std::shared_ptr<const ChainSeeds> seeds_;
    double effort_;
};

}  // namespace lacuna
