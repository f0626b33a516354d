// Searches for the chains of mirrors and smooth glass that join a point with a light that no ray can hit, by Newton's
// method [Hanika15]. It starts from ways by which light is known to come, or from a random ray. The probability of
// chains that a random ray leads to is estimated by searching until they are found again [Zeltner20]. (theory.md,
// "Specular chains")
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "libcore/base/rng.h"
#include "libcore/specular/chain_seeds.h"
#include "libcore/specular/chain_solver.h"
#include "libcore/specular/triangles_by_area.h"

namespace lacuna {

/// Whether a chain is one of those that other searches for the same target found.
bool isAmong(std::span<const FoundChain> chains, const FoundChain& found);

/// Finds chains by the ways that light is known to come. The caller has to ask whether a chain's edges are open.
class WayFollower {
  public:
    /// `scene` must outlive it.
    explicit WayFollower(const Scene& scene) : solver_(scene) {}

    const ChainSolver& solver() const { return solver_; }
    /// The chain that a way leads to; empty where it leads to none. A usual way is followed in the direction that it
    /// would have at the start. If that fails, other ways are followed towards their first vertex as well.
    std::optional<FoundChain> followUsual(const ChainSeed& way, const ChainQuery& query,
                                          RayTally& tally) const;
    std::optional<FoundChain> followOther(const ChainSeed& way, const ChainQuery& query,
                                          RayTally& tally) const;
    /// The chains that the usual ways lead to, each chain once.
    std::vector<FoundChain> usual(const ChainQuery& query, const WaysNearby& ways,
                                  RayTally& tally) const;
    /// How many of the other ways lead to a chain.
    std::size_t othersThatLeadTo(const FoundChain& found, const ChainQuery& query,
                                 const WaysNearby& ways, RayTally& tally) const;

  private:
    std::optional<FoundChain> follow(const ChainSeed& way, const Vec3d& direction,
                                     const ChainQuery& query, RayTally& tally) const;

    ChainSolver solver_;
};

/// Samples all chains.
class ChainSearch {
  public:
    /// `scene` must outlive it.
    explicit ChainSearch(const Scene& scene)
        : follower_(scene), triangles_(scene.trianglesOf(mayBeSpecular)) {}

    const WayFollower& follower() const { return follower_; }
    /// Whether the scene has nothing that a chain could begin at.
    bool empty() const { return triangles_.empty(); }

    /// An unbiased estimate of one over a chain's probability. It is computed only where it is needed, since it may
    /// take many searches.
    using Worth = std::function<double()>;
    /// Calls `bring` for some chains. Every chain that exists has an expected worth of one in total, whatever the ways
    /// are. The caller has to ask whether a chain's edges are open.
    void sample(const ChainQuery& query, const WaysNearby& ways, Rng& rng, RayTally& tally,
                const std::function<void(const FoundChain&, const Worth&)>& bring) const;

  private:
    double reciprocalProbability(const FoundChain& found, const ChainQuery& query, Rng& rng,
                                 RayTally& tally) const;
    Vec3d seedDirection(const ChainQuery& query, Rng& rng) const;
    std::optional<Chain> guess(const ChainQuery& query, Rng& rng, RayTally& tally) const;

    WayFollower follower_;
    TrianglesByArea triangles_;  // mirrors and smooth glass: what a chain may meet first
};

}  // namespace lacuna
