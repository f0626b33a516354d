// The chains of mirrors and smooth glass that join a point with a light that no ray can hit: one is
// searched from a random ray by Newton's method [Hanika15], and its probability estimated by
// searching until it is found again [Zeltner20]. (theory.md, "Specular chains")
#pragma once

#include <optional>

#include "libcore/base/rng.h"
#include "libcore/scene/scene.h"
#include "libcore/specular/chain.h"
#include "libcore/specular/specular_triangles.h"

namespace lacuna {

/// Where a chain begins: the eye's end.
struct ChainStart {
    Vec3 position, ng;
    Vec3 side;  ///< unit, on the side that light comes from; zero: both
};

/// Where it ends: a light without an extent.
struct ChainTarget {
    Vec3 position;  ///< at infinity: unit direction towards the light
    bool infinite = false;
};

/// What is searched for.
struct ChainQuery {
    ChainStart start;
    ChainTarget target;
    std::size_t most;  ///< vertices
};

/// Changes of two coordinates (rows) with two parameters.
using Jacobian = std::array<std::array<double, 2>, 2>;

/// A chain that meets its target.
struct FoundChain {
    Chain chain;
    /// Solid angle at the start per area across the light's last ray (at infinity: per solid angle of
    /// what leaves the chain). What the light's intensity (irradiance) is multiplied by.
    double spread;
    /// How what misses the target changes with the first ray's two angles.
    Jacobian missBy;
};

class ChainSearch {
  public:
    /// `scene` must outlive it.
    explicit ChainSearch(const Scene& scene) : scene_(scene), triangles_(scene) {}

    /// Nothing in the scene that a chain could begin at.
    bool empty() const { return triangles_.empty(); }

    /// One search from a random ray; empty where it finds no chain.
    /// Whether the chain sees its start and the light is for the caller to ask.
    std::optional<FoundChain> draw(const ChainQuery& query, Rng& rng, RayTally& tally) const;

    /// The chain of refractions alone that the straight ray to the target leads to: by what it runs
    /// through before the target, then by Newton's method. A function of the query [Hanika15].
    std::optional<FoundChain> throughGlass(const ChainQuery& query, RayTally& tally) const;

    /// Whether chains through glass run through this material: it stops every ray, which alpha and panes
    /// do not.
    bool mayBeThroughGlass(std::uint32_t material) const;
    /// Whether a path of the same events between the same ends, which begins along a unit direction that
    /// is known but for an angle, is this chain.
    bool isAlong(const FoundChain& found, const ChainQuery& query, const Vec3d& direction,
                 double angle, RayTally& tally) const;

    /// An estimate of one over the probability that draw() finds `found`, without bias. It has no
    /// bound; the mean number of searches is at most that number.
    double reciprocalProbability(const FoundChain& found, const ChainQuery& query, Rng& rng,
                                 RayTally& tally) const;

  private:
    Vec3d seedDirection(const ChainQuery& query, Rng& rng) const;
    std::optional<Chain> seed(const ChainQuery& query, Rng& rng, RayTally& tally) const;
    std::optional<FoundChain> solve(const ChainQuery& query, const Chain& seed,
                                    RayTally& tally) const;
    std::optional<Chain> retrace(const ChainStart& start, const Vec3d& direction,
                                 const Chain& events, RayTally& tally) const;
    std::optional<Hit> next(const ChainStart& start, const Chain& chain, RayTally& tally) const;

    const Scene& scene_;
    SpecularTriangles triangles_;
};

}  // namespace lacuna
