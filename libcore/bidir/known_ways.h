// Next event along known ways. An eye vertex is joined with a point of a lamp or of the sky over chains of mirrors and
// smooth glass, by which light was seen to arrive near that vertex. The chains are functions of the two ends, so their
// densities are known. Weights share the paths with eye walks that run into the light. All these paths have no edge
// that a connection could join, and those that next event through glass makes are left to it. (theory.md, "Next event
// along known ways")
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
    /// `walker` must outlive this object. `seeds` are those of its scene. `effort` is
    /// GlassEffort::knownWays.
    KnownWays(const Walker& walker, std::shared_ptr<const ChainSeeds> seeds, double effort)
        : walker_(walker), follower_(walker.scene()), seeds_(std::move(seeds)), effort_(effort) {}

    /// Samples paths from the last vertex of an eye subpath z_0 .. z_{t-1}, t >= 2, to a point of a lamp; mostly there
    /// are none. For each one it fills `path` and `light` (y_0 .. y_{s-1}, with a delta event at each but y_0), and
    /// calls `deliver`.
    void sample(Subpath eye, const TechniqueCounts& counts, Rng& rng, RayTally& tally,
                std::vector<PathVertex>& light, FullPath& path,
                const std::function<void(const Closed&)>& deliver) const;

    /// FullPath::refracted of a path that an eye walk made by running into the light, and that next event through
    /// glass cannot make.
    OverChain ratioOf(const FullPath& path, const TechniqueCounts& counts, RayTally& tally) const;

  private:
    // The product of these two is n(z), the expected number of samples at an eye vertex.
    double mostSamples(int order) const;
    static double shareOfSamples(const WaysNearby& ways);
    struct Known {
        FoundChain found;
        bool isUsual;
        double pmf;  // of this chain among all between the two ends
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
