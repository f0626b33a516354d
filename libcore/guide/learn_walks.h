// Learns the guide that makes the second moment of walks small, from paths that reached the picture. (theory.md,
// "Guided walks")
#pragma once

#include <array>
#include <memory>

#include "libcore/guide/walk_samples.h"

namespace lacuna {

class ThreadPool;

struct LearnedWalks {
    std::shared_ptr<const WalkGuide> guide;
    /// By Side: second moment of the guide over that of BSDFs alone, on the paths that were held out.
    std::array<double, 2> heldOutLoss{1.0, 1.0};
    double virtualSamples = 0.0;    ///< for cosine-distributed directions, in every split
    double samplesPerRegion = 0.0;  ///< both as held-out paths chose them
};

/// The guide of least second moment on `heldOut` among some that are learned from `train`; null where
/// none is better than BSDFs. Contributions must be relative to their pixels.
LearnedWalks learnWalks(const WalkSamples& train, const WalkSamples& heldOut,
                        const ThreadPool& pool);

}  // namespace lacuna
