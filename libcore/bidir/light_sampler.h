// Fresh light points: next event. Implemented by the walker, and by tests on finite spaces.
// (theory.md, "Lamps that are seen")
#pragma once

#include "libcore/base/rng.h"
#include "libcore/bidir/path.h"

namespace lacuna {

class LightSampler {
  public:
    /// A draw of sampleSeenLight.
    struct Seen {
        double samples = 0.0;  ///< seenSamples of the point, or zero where the draw gives nothing
        float factor = 1.0f;   ///< Lights::SeenPoint::factor
        /// What the point brings with the density of light walks has this factor.
        double weight() const { return double(factor) / samples; }
    };

    virtual ~LightSampler() = default;
    /// Draws y_0 as light walks do. False where the draw gives nothing: no light has power, or the
    /// point is dark.
    virtual bool sampleLight(Rng& rng, PathVertex& out) const = 0;
    /// Draws y_0 on a light that is picked by what `eye` sees of it. Density and throughput of `out`
    /// are those of light walks.
    virtual Seen sampleSeenLight(const PathVertex& eye, Rng& rng, PathVertex& out) const = 0;
    /// Density of y_0 by sampleSeenLight over its density by light walks. A function of y_0, of the
    /// place of `eye` and of its side.
    virtual double seenSamples(const PathVertex& light, const PathVertex& eye) const = 0;
};

}  // namespace lacuna
