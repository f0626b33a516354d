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

/// What to search for: the two ends of a chain, and its greatest length.
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
    /// what leaves the chain). The light's intensity (irradiance) is multiplied by it.
    double spread;
    /// How the miss at the target changes with the first ray's two angles.
    Jacobian missBy;
};

/// Whether two chains of the same events to the same target lie on the same side of a caustic's fold. Chains that lie
/// close together on different sides of a fold have determinants of opposite signs.
bool onSameSideOfFold(const Jacobian& a, const Jacobian& b);

class ChainSolver {
  public:
    /// `scene` must outlive it.
    explicit ChainSolver(const Scene& scene) : scene_(scene) {}

    const Scene& scene() const { return scene_; }
    /// The hit of a chain's last ray.
    std::optional<Hit> next(const ChainStart& start, const Chain& chain, RayTally& tally) const;
    /// The chain of the same events as `seed` that meets the target; empty where the method finds none.
    /// The caller has to ask whether its edges are open.
    std::optional<FoundChain> solve(const ChainQuery& query, const Chain& seed,
                                    RayTally& tally) const;

    /// The chain of refractions that a ray along a unit direction leads to. All glass that the ray meets before the
    /// target refracts it, and Newton's method does the rest. Where that finds no chain and the ray leaves glass,
    /// it is done once more, in the direction that the surface would refract to the target. The chain is a function
    /// of the query and the direction. Only glass that stops every ray counts. Nearly smooth glass refracts as if
    /// it were smooth.
    std::optional<FoundChain> throughGlass(const ChainQuery& query, const Vec3d& direction,
                                           RayTally& tally) const;
    /// The chain that `smooth` becomes with these facets, one for each vertex (used where glass is nearly smooth).
    std::optional<FoundChain> withFacets(const ChainQuery& query, const FoundChain& smooth,
                                         std::span<const FacetSlope> facets, RayTally& tally) const;
    /// Whether a path of the same events between the same ends is this chain. The path begins along the unit
    /// `direction`, which is known up to `angle`, in radians.
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
