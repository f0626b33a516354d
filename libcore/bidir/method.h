// The seam between the one integrator and the methods: how a light vertex is picked for an eye
// vertex (with its realised probability), and what the weights believe about that pick. These are
// two different numbers, so they are two interfaces (architecture.md).
//
// A Method lives for the whole render and owns its caches. Per iteration:
//   freeze -> light pass -> prepare(pool) -> eye pass (select, in parallel) -> observe
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "libcore/base/rng.h"
#include "libcore/bidir/mis.h"
#include "libcore/bidir/path.h"
#include "libcore/bidir/statistics.h"

namespace lacuna {

class ThreadPool;
struct Skeleton;
struct Subspaces;

/// Asks the cache for a vertex that will be looked at soon.
inline void prefetch(const PathVertex& vertex) {
    const char* bytes = reinterpret_cast<const char*>(&vertex);
    for (std::size_t i = 0; i < sizeof(PathVertex); i += 64) __builtin_prefetch(bytes + i);
}

/// The light vertices of this iteration's M subpaths. A subpath's vertices are contiguous, so the
/// prefix of any vertex is the `count` entries that end with it.
class LightPool {
  public:
    /// A vertex that a connection may end at: y_{s-1}, s = count.
    struct Entry {
        std::uint32_t vertex, count;
    };

    /// Empties the pool for `subpaths` new ones.
    void reset(std::uint64_t subpaths) {
        vertices_.clear();
        connectable_.clear();
        subpaths_ = subpaths;
    }
    /// Whole subpaths, one after the other. With maxDepth edges, y_{s-1} can be connected while
    /// s + t - 1 <= maxDepth for t = 2.
    void add(std::span<const PathVertex> vertices, int maxDepth) {
        for (const PathVertex& v : vertices) {
            if (int(v.index) <= maxDepth - 2 && v.connectable()) {
                connectable_.push_back({std::uint32_t(vertices_.size()), v.index + 1u});
            }
            vertices_.push_back(v);
        }
    }

    /// M, those without any vertex included.
    std::uint64_t subpaths() const { return subpaths_; }
    std::span<const PathVertex> vertices() const { return vertices_; }
    std::span<const Entry> connectable() const { return connectable_; }

    /// y_0 .. y_{s-1}. Asks the cache for the last vertex: it will be looked at soon, and lies
    /// anywhere in some hundred megabytes.
    Subpath prefix(Entry entry) const {
        const PathVertex* last = vertices_.data() + entry.vertex;
        prefetch(*last);
        return {last + 1 - entry.count, entry.count};
    }

  private:
    std::vector<PathVertex> vertices_;
    std::vector<Entry> connectable_;
    std::uint64_t subpaths_ = 0;
};

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

/// Draws fresh y_0: next event. Implemented by the walker (and by tests on finite spaces).
class LightSampler {
  public:
    virtual ~LightSampler() = default;
    /// False where the draw gives nothing: no light has power, or the point is dark.
    virtual bool sampleLight(Rng& rng, PathVertex& out) const = 0;
};

/// The space that paths live in, as far as methods look at it outside of select(). Implemented for
/// scenes (path_space.h) and by tests on finite spaces.
class PathSpace {
  public:
    virtual ~PathSpace() = default;

    /// Replaces `out` by an eye subpath through a uniform point of the whole film.
    virtual void traceEye(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const = 0;

    /// What arrives where a light subpath meets an eye subpath's last vertex; visibility, and what
    /// coloured glass absorbs between the two, left out.
    struct Arrival {
        Rgb flow;             ///< beta rho at the light's end
        Rgb scattered;        ///< flow times rho at the eye's end, where asked for
        double geometry = 0;  ///< G
    };
    /// Zero where what comes from behind the eye's last vertex would not be scattered there.
    virtual Arrival arrival(Subpath light, Subpath eye, bool throughEye) const = 0;
    virtual bool visible(const PathVertex& light, const PathVertex& eye, RayTally& tally) const = 0;
    /// Distance along a unit direction from a point in empty space to the first surface; infinite
    /// where there is none.
    virtual float reach(const Vec3& origin, const Vec3& direction, RayTally& tally) const = 0;
};

/// What prepare() and observe() may use and must account for.
struct IterationContext {
    const PathSpace& space;
    const ThreadPool& threads;
    std::uint64_t seed;
    std::uint64_t filmPixels;  ///< of the whole film, whatever the crop
    IterationStatistics& statistics;
};

/// What a selector may look at.
struct EyeContext {
    const PathVertex& vertex;  ///< z_{t-1}
    Subpath eyePath;           ///< z_0 .. z_{t-1}
    Subpath ownLightPath;      ///< the pixel's own light subpath, where the row asks for it
    std::uint32_t pixel;
    std::uint32_t iteration;
    const LightSampler& lights;

    int t() const { return int(eyePath.size()); }
    const PathVertex& predecessor() const { return eyePath[eyePath.size() - 2]; }
    /// Connection::order of connections with this vertex.
    int order() const { return connectionOrder(eyePath); }
};

/// Which techniques a method takes part in; fixed for the render.
struct TechniqueSet {
    bool hits = false;          ///< s = 0: eye paths that run into a light
    bool connects = false;      ///< t >= 2, s >= 1 through select()
    bool splats = false;        ///< t = 1: light paths seen by the lens
    bool ownLightPath = false;  ///< every pixel traces a light subpath of its own
};

/// Light subpaths of one iteration.
struct PoolRequest {
    std::uint64_t subpaths = 0;  ///< M: stored for selection; 0: no pool
};

class Method {
  public:
    virtual ~Method() = default;

    /// Rows that need a skeleton get it before anything else; without it they must still work.
    virtual void useSkeleton(std::shared_ptr<const Skeleton> skeleton) { (void)skeleton; }
    /// Likewise for rows that need subspaces.
    virtual void useSubspaces(std::shared_ptr<const Subspaces> subspaces) { (void)subspaces; }
    /// Iterations to run and throw away before the first one that counts.
    virtual int warmupIterations() const { return 0; }
    virtual PoolRequest pool() const { return {}; }

    /// What the weights believe in the coming iteration: may depend on earlier iterations alone.
    /// Valid until the next call.
    virtual const ConnectionDensity& freeze(std::uint32_t iteration) = 0;
    /// Builds this iteration's pmfs, trees, bins. `pool` stays valid and unchanged until observe().
    virtual void prepare(const LightPool& pool, IterationContext& context) {
        (void)pool, (void)context;
    }
    /// Appends 0..n proposals. Called from many threads at once.
    virtual void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const = 0;
    /// What later iterations may learn from; after warm-ups as well.
    virtual void observe(const LightPool& pool, IterationContext& context) {
        (void)pool, (void)context;
    }
    /// Whether an iteration depends on earlier ones beyond the warm-up: --replay then runs them
    /// again.
    virtual bool learns() const { return false; }
};

}  // namespace lacuna
