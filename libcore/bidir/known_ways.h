// Next event along known ways: an eye vertex is joined with a point of a lamp or of the sky over the chains
// of mirrors and smooth glass that light was seen to come by near that vertex. They are functions of the two
// ends, so that their densities are known and walks that run into the light share their paths with them by
// weights. Only paths that no edge can be joined on, which nothing else makes but next event through glass.
// (theory.md, "Next event along known ways")
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libcore/bidir/close.h"
#include "libcore/specular/chain_search.h"

namespace lacuna {

class KnownWays {
  public:
    /// `walker` must outlive it. `seeds`: of its scene. `effort`: GlassEffort::knownWays.
    KnownWays(const Walker& walker, std::shared_ptr<const ChainSeeds> seeds, double effort)
        : walker_(walker), follower_(walker.scene()), seeds_(std::move(seeds)), effort_(effort) {}

    /// Paths from an eye subpath's last vertex, z_0 .. z_{t-1}, t >= 2, to a point of a lamp; mostly none.
    /// For each, fills `light`, y_0 .. y_{s-1} with a delta event at each but y_0, and `path`, and calls
    /// `deliver`.
    void sample(Subpath eye, const TechniqueCounts& counts, Rng& rng, RayTally& tally,
                std::vector<PathVertex>& light, FullPath& path,
                const std::function<void(const Closed&)>& deliver) const;

    /// FullPath::refracted of a path that a walk made which ran into the light, and of which next event
    /// through glass knows nothing.
    OverChain ratioOf(const FullPath& path, const TechniqueCounts& counts, RayTally& tally) const;

  private:
    // n(z), the expected number of samples at an eye vertex, is the product of these.
    double mostSamples(int order) const;
    static double shareOfSamples(const WaysNearby& ways);
    struct Known {
        FoundChain found;
        bool isUsual;
        double pmf;  // of this one of all chains between the two
    };
    std::optional<Known> knownOf(const FullPath& path, std::size_t count, const ChainQuery& query,
                                 const WaysNearby& ways, RayTally& tally) const;
    double densityOf(const Known& known, const PathVertex& y0) const;

    const Walker& walker_;
    WayFollower follower_;
    std::shared_ptr<const ChainSeeds> seeds_;
    double effort_;
};

/// FullPath::refracted of a path that neither next event through glass made nor next event along known
/// ways. `anew` as in RefractedLamps::ratioOf.
OverChain refractedRatioOf(const FullPath& path, const TechniqueCounts& counts, RayTally& tally,
                           bool anew = false);

}  // namespace lacuna
