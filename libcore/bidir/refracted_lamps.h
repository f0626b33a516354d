// Next event through glass [Hanika15]. At an eye vertex a point of a lamp or of the sky is drawn, and joined over the
// one chain of refractions that the straight ray leads to. Where glass is nearly smooth, the facets that refract are
// drawn too. Unlike other specular chains, this one is a function of its ends and facets. So its density is known, and
// weights share the paths with other techniques. (theory.md, "Next event through glass")
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libcore/bidir/close.h"
#include "libcore/specular/chain_solver.h"
#include "libcore/specular/smooth_glass.h"

namespace lacuna {

class RefractedLamps {
  public:
    /// `walker` must outlive this object. `glass` is that of its scene and not empty. `effort` is
    /// GlassEffort::refractions.
    RefractedLamps(const Walker& walker, std::shared_ptr<const SmoothGlass> glass, double effort)
        : walker_(walker), solver_(walker.scene()), glass_(std::move(glass)), effort_(effort) {}

    /// Samples a path from the last vertex of an eye subpath z_0 .. z_{t-1}, t >= 2, through glass to a lamp. Mostly
    /// the result is empty. Fills `path` and `light` (y_0 .. y_{s-1}, with a refraction at each but y_0).
    std::optional<Closed> sample(Subpath eye, Rng& rng, RayTally& tally,
                                 std::vector<PathVertex>& light, FullPath& path) const;

    /// Sets PathVertex::throughGlass of a whole light subpath.
    void look(std::span<PathVertex> light, RayTally& tally) const;

    /// FullPath::refracted of a path that another technique made. PathVertex::throughGlass is used where the light
    /// subpath has it, unless `anew`.
    OverChain ratioOf(const FullPath& path, RayTally& tally, bool anew = false) const;

    /// Whether there may be anything to sample at z. Mostly, in most scenes, there is not.
    bool mayBring(const PathVertex& z) const {
        return !z.infinite() && glass_->shadows().reach(z.position);
    }
    /// n(z): the expected number of samples at an eye vertex of this order. It does not depend on the walk that made z.
    double samplesAt(const PathVertex& z, int order) const;

  private:
    struct Joined {
        FoundChain found;
        double pmf;  // of this chain among all between the two ends
    };
    /// The facets at a path's refractions.
    class Facets;
    std::optional<Facets> facetsOf(const FullPath& path) const;
    OverChain ratioBy(const FullPath& path, int vertices, double density) const;
    bool mayReach(std::uint32_t light, bool byFacet) const;
    bool refracts(const PathVertex& v, bool delta, const Vec3& toEye, const Vec3& toLight) const;
    std::optional<Joined> drawBetween(const PathVertex& z, const PathVertex& y0, double u,
                                      RayTally& tally) const;
    std::optional<Joined> betweenOver(const Vec3& normal, const PathVertex& z, const PathVertex& y0,
                                      RayTally& tally) const;
    std::optional<Joined> straight(const PathVertex& z, const PathVertex& y0,
                                   RayTally& tally) const;
    std::optional<Joined> out(const GlassBodies::WaysOut& ways, const GlassBodies::WayOut& way,
                              const PathVertex& z, const PathVertex& y0, RayTally& tally) const;
    std::optional<Joined> turned(const Joined& smooth, const Facets& facets, const PathVertex& z,
                                 const PathVertex& y0, RayTally& tally) const;
    double densityAt(const PathVertex& y0, double seenSamples, const Joined& joined) const;
    double densityOver(const Joined& smooth, double seenSamples, const PathVertex& z,
                       const PathVertex& y0, const PathVertex& last, const Facets& facets,
                       const Vec3& toChain, RayTally& tally) const;
    double densityOfChain(const PathVertex& z, const PathVertex& y0, const PathVertex& last,
                          const Facets& facets, const Vec3& toChain, RayTally& tally) const;

    const Walker& walker_;
    ChainSolver solver_;
    std::shared_ptr<const SmoothGlass> glass_;
    double effort_;
};

}  // namespace lacuna
