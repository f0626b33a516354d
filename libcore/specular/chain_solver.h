// Newton's method on the first ray of a chain of mirrors and smooth glass, until the last one meets its
// target [Hanika15]. (theory.md, "Specular chains", "Next event through glass")
#pragma once

#include <array>
#include <optional>
#include <span>

#include "libcore/scene/scene.h"
#include "libcore/specular/chain.h"
#include "libcore/specular/snell.h"

namespace lacuna {

/// Where a chain begins: the eye's end.
struct ChainStart {
    Vec3 position, ng;
    Vec3 side;  ///< unit, on the side that light comes from; zero: both
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

/// Whether two chains of the same events to the same target are not divided by a fold of a caustic: those
/// that lie close together on either side of one have determinants of opposite signs.
bool onSameSideOfFold(const Jacobian& a, const Jacobian& b);

class ChainSolver {
  public:
    /// `scene` must outlive it.
    explicit ChainSolver(const Scene& scene) : scene_(scene) {}

    const Scene& scene() const { return scene_; }
    /// What the last ray of a chain meets.
    std::optional<Hit> next(const ChainStart& start, const Chain& chain, RayTally& tally) const;
    /// The chain of the same events as `seed` that meets the target; empty where the method finds none.
    /// Whether it sees its start and the light is for the caller to ask.
    std::optional<FoundChain> solve(const ChainQuery& query, const Chain& seed,
                                    RayTally& tally) const;

    /// The chain of refractions alone that a ray along a unit direction leads to: by what it runs through
    /// before the target, then by Newton's method. Where that finds none and the ray leaves glass, once more
    /// by where the surface would refract it to the target. A function of all three. Through glass alone that
    /// stops every ray; what is nearly smooth refracts as if it were smooth.
    std::optional<FoundChain> throughGlass(const ChainQuery& query, const Vec3d& direction,
                                           RayTally& tally) const;
    /// That chain once its facets are turned, one for each vertex (used where glass is nearly smooth).
    std::optional<FoundChain> withFacets(const ChainQuery& query, const FoundChain& smooth,
                                         std::span<const FacetSlope> facets, RayTally& tally) const;
    /// Whether a path of the same events between the same ends, which begins along a unit direction that
    /// is known but for an angle, is this chain.
    bool isAlong(const FoundChain& found, const ChainQuery& query, const Vec3d& direction,
                 double angle, RayTally& tally) const;

  private:
    bool retrace(const ChainStart& start, const Vec3d& direction, const Chain& events, Chain& chain,
                 RayTally& tally, std::span<const FacetSlope> facets = {}) const;
    bool stopsAllRaysAlong(const Chain& chain) const;
    struct Refracted;
    bool refractAt(const Hit& hit, Chain& chain) const;
    Refracted refracted(const ChainQuery& query, const Vec3d& direction, RayTally& tally) const;
    std::optional<FoundChain> solvedThroughGlass(const ChainQuery& query, const Chain& chain,
                                                 RayTally& tally) const;
    std::optional<Vec3d> turnedToLeave(const ChainQuery& query, const Refracted& ray) const;

    const Scene& scene_;
};

}  // namespace lacuna
