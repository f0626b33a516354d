// Learns the emission guide that makes the second moment of light subpaths small, from paths that
// reached the picture. (theory.md, "Learned emission")
#pragma once

#include <memory>

#include "libcore/guide/emission_samples.h"
#include "libcore/scene/emission_guide.h"

namespace lacuna {

class ThreadPool;

struct LearnedEmission {
    std::shared_ptr<const EmissionGuide> guide;
    /// Second moment of the guide over that of plain emission, on the paths that were held out.
    double heldOutLoss = 1.0;
    double trainLoss = 1.0;     ///< the same on the paths that were learned from
    double plainShare = 1.0;    ///< of plain emission in the mixture, as held-out paths chose it
    double virtualSamples = 0;  ///< for an even split, likewise
};

/// The guide of least second moment on `heldOut` among some that are learned from `train`; null
/// where none is better than plain emission. Contributions must be relative to their pixels.
LearnedEmission learnEmission(const Lights& lights, const EmissionSamples& train,
                              const EmissionSamples& heldOut, const ThreadPool& pool);

}  // namespace lacuna
