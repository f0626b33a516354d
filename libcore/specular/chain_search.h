// The chains of mirrors and smooth glass that join a point with a light that no ray can hit: one is
// searched along the ways that light is known to come, and from a random ray, by Newton's method
// [Hanika15]. The probability of what a random ray found is estimated by searching until it is found
// again [Zeltner20]. (theory.md, "Specular chains")
#pragma once

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
    /// The chain that a way leads to; empty where it leads to none.
    std::optional<FoundChain> follow(const ChainSeed& way, const ChainQuery& query,
                                     RayTally& tally) const;
    /// The chains that one way of each kind leads to, each chain once.
    std::vector<FoundChain> usual(const ChainQuery& query, const WaysNearby& ways,
                                  RayTally& tally) const;
    /// What Newton's method begins with along a way.
    std::optional<Chain> along(const ChainSeed& way, const ChainQuery& query,
                               RayTally& tally) const;

  private:
    ChainSolver solver_;
};

/// Chains by chance.
class ChainSearch {
  public:
    /// `scene` must outlive it.
    explicit ChainSearch(const Scene& scene)
        : follower_(scene), triangles_(scene.trianglesOf(mayBeSpecular)) {}

    const WayFollower& follower() const { return follower_; }
    /// Nothing in the scene that a chain could begin at.
    bool empty() const { return triangles_.empty(); }

    // Whether a chain sees its start and the light is for the caller to ask.

    /// One search from a random ray; empty where it finds no chain.
    /// `known`, ways to places nearby, may be any, as long as reciprocalProbability is given the same.
    std::optional<FoundChain> draw(const ChainQuery& query, std::span<const ChainSeed> known,
                                   Rng& rng, RayTally& tally) const;

    /// An estimate of one over the probability that draw() finds `found`, without bias. It has no
    /// bound; the mean number of searches is at most that number.
    double reciprocalProbability(const FoundChain& found, const ChainQuery& query,
                                 std::span<const ChainSeed> known, Rng& rng, RayTally& tally) const;

  private:
    Vec3d seedDirection(const ChainQuery& query, Rng& rng) const;
    std::optional<Chain> seed(const ChainQuery& query, std::span<const ChainSeed> known, Rng& rng,
                              RayTally& tally) const;
    std::optional<Chain> guess(const ChainQuery& query, Rng& rng, RayTally& tally) const;

    WayFollower follower_;
    TrianglesByArea triangles_;  // mirrors and smooth glass: what a chain may meet first
};

}  // namespace lacuna
