// The chains of mirrors and smooth glass that join a point with a light that no ray can hit, by Newton's
// method [Hanika15]: those that ways lead to by which light is known to come, and those that it finds from a
// random ray. The probability of the latter is estimated by searching until they are found again [Zeltner20].
// (theory.md, "Specular chains")
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

/// Chains by the ways that light is known to come. Whether a chain sees its start and the light is for the
/// caller to ask.
class WayFollower {
  public:
    /// `scene` must outlive it.
    explicit WayFollower(const Scene& scene) : solver_(scene) {}

    const ChainSolver& solver() const { return solver_; }
    /// The chain that a way leads to; empty where it leads to none. A usual way is followed in the direction
    /// that it would have, others to their first vertex as well.
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

/// All chains.
class ChainSearch {
  public:
    /// `scene` must outlive it.
    explicit ChainSearch(const Scene& scene)
        : follower_(scene), triangles_(scene.trianglesOf(mayBeSpecular)) {}

    const WayFollower& follower() const { return follower_; }
    /// Nothing in the scene that a chain could begin at.
    bool empty() const { return triangles_.empty(); }

    /// What a chain stands for: one over its probability, without bias. Asked for where it is needed, since it
    /// may take many searches.
    using Worth = std::function<double()>;
    /// Calls `bring` for some chains: E of the sum of their worths is the number of chains that there are,
    /// each counted once, whatever the ways are. Whether a chain sees its start and the light is for the
    /// caller to ask.
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
