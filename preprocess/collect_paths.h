// D, the full paths that SPCBPT trains with, by bidirectional path tracing [Su22 7.1].
#pragma once

#include <atomic>

#include "libcore/base/parallel.h"
#include "libcore/subspace/training_paths.h"
#include "preprocess/training_view.h"

namespace lacuna {

struct CollectedPaths {
    TrainingPaths train, heldOut;  ///< contributions relative to their pixels
    std::uint64_t traced = 0;      ///< paths that carry something, with those left out
    std::uint64_t outliers = 0;    ///< of both sets: contributions lowered to the limit
    std::uint64_t iterations = 0;
};

/// About `paths` paths that connections can make, or as many as a hundred iterations give; a tenth
/// of the pixels is held out. Throws Error 130 once `cancel` is set.
CollectedPaths collectPaths(const Scene& scene, const TrainingView& view, const LightCells& cells,
                            std::uint64_t paths, std::uint64_t seed, const ThreadPool& pool,
                            const std::atomic<bool>& cancel);

}  // namespace lacuna
