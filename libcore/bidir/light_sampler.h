// Fresh light points: next event. Implemented by the walker, and by tests on finite spaces.
// (theory.md, "Lamps that are seen")
#pragma once

#include "libcore/base/rng.h"
#include "libcore/bidir/path.h"

namespace lacuna {

class LightSampler {
  public:
    virtual ~LightSampler() = default;
    /// Draws y_0 as light walks do. False where the draw gives nothing: no light has power, or the
    /// point is dark.
    virtual bool sampleLight(Rng& rng, PathVertex& out) const = 0;
    /// Draws y_0 on a light that is picked by what `eye` sees of it: seenSamples of the draw, zero
    /// where it gives nothing. Density and throughput of `out` are those of light walks.
    virtual double sampleSeenLight(const PathVertex& eye, Rng& rng, PathVertex& out) const = 0;
    /// Density of sampleSeenLight over that of light walks: how many of their points one of its
    /// points is worth. A function of y_0, the place of `eye` and its side.
    virtual double seenSamples(const PathVertex& light, const PathVertex& eye) const = 0;
};

}  // namespace lacuna
