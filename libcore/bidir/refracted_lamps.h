// Next event through smooth glass [Hanika15]: at an eye vertex a point of a lamp or of the sky is drawn,
// and joined over the one chain of refractions that the straight ray leads to. Unlike other specular
// chains that one is a function of its ends, so that its density is known and other techniques share
// their paths with it by weights. (theory.md, "Next event through glass")
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "libcore/bidir/close.h"
#include "libcore/specular/chain_solver.h"
#include "libcore/specular/glass_boxes.h"

namespace lacuna {

class RefractedLamps {
  public:
    /// `walker` must outlive it.
    explicit RefractedLamps(const Walker& walker);

    /// The scene has no lamp with a size and no sky, or no smooth glass.
    bool empty() const { return !anyLamp_ || glass_.empty(); }

    /// A path from an eye subpath's last vertex, z_0 .. z_{t-1}, t >= 2, through glass to a lamp; mostly
    /// none. Fills `light`, y_0 .. y_{s-1} with a refraction at each but y_0, and `path`.
    std::optional<Closed> sample(Subpath eye, Rng& rng, RayTally& tally,
                                 std::vector<PathVertex>& light, FullPath& path) const;

    /// Sets PathVertex::throughGlass of a whole light subpath.
    void look(std::span<PathVertex> light, RayTally& tally) const;

    /// FullPath::refracted of a path that another technique made. What its light subpath knows is not
    /// looked up again, unless `anew`.
    double ratioOf(const FullPath& path, RayTally& tally, bool anew = false) const;

  private:
    bool isGlass(const PathVertex& v) const;
    std::optional<FoundChain> between(const PathVertex& z, const PathVertex& y0,
                                      RayTally& tally) const;
    double densityAt(const PathVertex& y0, const FoundChain& found, const PathVertex& z) const;
    double densityOfChain(const PathVertex& z, const PathVertex& y0, const PathVertex& last,
                          std::size_t vertices, const Vec3& toChain, RayTally& tally) const;

    const Walker& walker_;
    ChainSolver solver_;
    GlassBoxes glass_;
    bool anyLamp_ = false;
};

}  // namespace lacuna
