// The first step of lacuna-train and lacuna-render --prepare: learns in rounds how light subpaths
// should begin. (theory.md, "Learned emission")
#pragma once

#include <atomic>

#include "libcore/base/parallel.h"
#include "libcore/cache/cache_name.h"
#include "libcore/guide/learn_emission.h"
#include "preprocess/training_view.h"

namespace lacuna {

/// The inputs of learned emission. `paths`: number of training paths.
CacheStamp emissionStamp(const Settings& sceneInputs, const Settings& viewInputs,
                         std::uint64_t paths);

struct EmissionTraining {
    LearnedEmission learned;                       ///< by the last round
    std::size_t trainPaths = 0, heldOutPaths = 0;  ///< in all rounds
};

/// Learns from about `paths` paths. `aspect`: width over height of the picture. Throws InterruptedError once `cancel`
/// is set.
EmissionTraining trainEmission(const Scene& scene, const Camera& camera, double aspect,
                               const WalkLimits& limits, std::uint64_t paths, std::uint64_t seed,
                               const ThreadPool& pool, const std::atomic<bool>& cancel);

}  // namespace lacuna
