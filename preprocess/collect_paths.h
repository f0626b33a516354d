// The set D of full paths with which SPCBPT is trained, from bidirectional path tracing [Su22 7.1].
#pragma once

#include <atomic>

#include "libcore/base/parallel.h"
#include "libcore/subspace/training_paths.h"
#include "preprocess/training_view.h"

namespace lacuna {

struct CollectedPaths {
    TrainingPaths train, heldOut;  ///< contributions are relative to their pixels
    std::uint64_t traced = 0;      ///< contributing paths, including those left out
    std::uint64_t outliers = 0;    ///< in both sets: contributions lowered to the limit
    std::uint64_t iterations = 0;
};

/// Collects about `paths` paths that connections can make, or as many as a hundred iterations give;
/// a tenth of the pixels is held out. Throws InterruptedError once `cancel` is set.
CollectedPaths collectPaths(const Scene& scene, const TrainingView& view, const LightCells& cells,
                            std::uint64_t paths, std::uint64_t seed, const ThreadPool& pool,
                            const std::atomic<bool>& cancel);

}  // namespace lacuna
