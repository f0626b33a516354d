// The seam between the one integrator and the methods: how a light vertex is picked for an eye
// vertex (with its realised probability), and what the weights believe about that pick (density.h).
// These are two different numbers, so they are two interfaces. (theory.md, "What is exact, and
// why")
//
// A Method lives for a block of iterations (theory.md, "Blocks") and owns what it learns in it. Per
// iteration:
//   freeze -> light pass -> prepare(pool) -> eye pass (select, in parallel) -> observe
//
// A method only asks for merging (merging()); the integrator does it.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "libcore/base/rng.h"
#include "libcore/bidir/asset_set.h"
#include "libcore/bidir/density.h"
#include "libcore/bidir/light_sampler.h"
#include "libcore/bidir/merging.h"
#include "libcore/bidir/path_space.h"
#include "libcore/bidir/pool.h"
#include "libcore/bidir/sharing.h"

namespace lacuna {

/// A light vertex proposed for an eye vertex. `weight` holds everything about the pick, so that
/// E[sum weight g] = (1/M) sum of g over this iteration's pool.
struct Proposal {
    Subpath light;  ///< y_0 .. y_{s-1}
    double weight = 1.0;
    std::uint32_t label = 0;  ///< routes the contribution to a layer (distribution, node, subspace)
};

/// Collects the proposals for the vertices of an eye path; fresh light vertices live in it until it
/// is cleared.
class ProposalSink {
  public:
    void clear() {
        proposals_.clear();
        freshCount_ = 0;
    }
    void add(const Proposal& proposal) { proposals_.push_back(proposal); }
    /// Room for a fresh light vertex, which stays where it is.
    PathVertex& newVertex() {
        if (freshCount_ == fresh_.size()) fresh_.emplace_back();
        return fresh_[freshCount_++];
    }
    std::span<const Proposal> proposals() const { return proposals_; }

  private:
    std::vector<Proposal> proposals_;
    std::deque<PathVertex> fresh_;
    std::size_t freshCount_ = 0;
};

/// The data that a selector may look at.
struct EyeContext {
    const PathVertex& vertex;  ///< z_{t-1}
    Subpath eyePath;           ///< z_0 .. z_{t-1}
    Subpath ownLightPath;      ///< the pixel's own light subpath, where the row asks for it
    std::uint32_t pixel;       ///< row-major in the full film
    std::uint32_t iteration;
    const LightSampler& lights;
    const PathSpace& space;
    RayTally& tally;  ///< of the rays that the selector traces through the space

    int t() const { return int(eyePath.size()); }
    const PathVertex& predecessor() const { return eyePath[eyePath.size() - 2]; }
    /// Connection::order of connections with this vertex.
    int order() const { return connectionOrder(eyePath); }
};

/// Which techniques a method takes part in; fixed for the render.
struct Techniques {
    bool hits = false;          ///< s = 0: eye paths that run into a light
    bool connects = false;      ///< t >= 2, s >= 1 through select()
    bool splats = false;        ///< t = 1: light paths seen by the lens
    bool ownLightPath = false;  ///< every pixel traces a light subpath of its own
    /// Specular chains, for paths that none of all these makes. Only with connections, and where nothing is merged.
    bool chains = true;
    /// Next event through smooth glass. Only with hits and connections.
    bool refractions = true;
    /// Next event along known ways. Only with hits and connections, and where nothing is merged.
    bool knownWays = true;

    bool refract() const { return hits && connects && refractions; }
    bool goKnownWays() const { return hits && connects && knownWays; }
    bool searchForChains() const { return connects && chains; }
    /// Whether ChainSeeds are asked for.
    bool askForWays() const { return searchForChains() || goKnownWays(); }
};

class Method {
  public:
    virtual ~Method() = default;

    /// Gives a row the assets that it needs, before anything else. It must still work without them.
    virtual void use(const AssetSet& assets) { (void)assets; }
    /// Iterations to run and throw away before the first one of a block that counts.
    virtual int warmupIterations() const { return 0; }
    virtual PoolRequest pool() const { return {}; }
    /// Which paths are merged with the vertices of the pool, its M subpaths; fixed for the render.
    /// Wherever it is not Nowhere the picture is consistent, not unbiased.
    virtual Merging merging() const { return {}; }
    /// How pixels share eye walks; fixed for the render. Only for methods whose set of possible proposals at a vertex
    /// is the same from wherever it is seen on that side.
    virtual Sharing sharing() const { return {}; }

    /// The belief of the weights in the coming iteration. It may depend on earlier iterations
    /// alone. Valid until the next call.
    virtual const ConnectionDensity& freeze(std::uint32_t iteration) = 0;
    /// Builds this iteration's pmfs, trees, bins. `pool` stays valid and unchanged until observe().
    virtual void prepare(const LightPool& pool, IterationContext& context) {
        (void)pool, (void)context;
    }
    /// Appends 0..n proposals. Called from many threads at once.
    virtual void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const = 0;
    /// Learns for later iterations. Called after warm-ups as well.
    virtual void observe(const LightPool& pool, IterationContext& context) {
        (void)pool, (void)context;
    }
    /// Whether an iteration depends on earlier ones of its block beyond the warm-up: --replay then
    /// runs them again, and an interrupted block is begun anew.
    virtual bool learns() const { return false; }
    /// Whether the iterations of a block share light paths, so that only blocks are independent.
    virtual bool sharesLightPaths() const { return false; }
};

}  // namespace lacuna
