// What lacuna-train does first, and lacuna-render --prepare: where light subpaths begin and set out,
// learned in rounds. (theory.md, "Learned emission")
#pragma once

#include <atomic>

#include "libcore/base/parallel.h"
#include "libcore/cache/cache_name.h"
#include "libcore/guide/learn_emission.h"
#include "preprocess/training_view.h"

namespace lacuna {

/// What learned emission is made of: so many paths.
CacheStamp emissionStamp(const Settings& sceneInputs, const Settings& viewInputs,
                         std::uint64_t paths);

struct EmissionTraining {
    LearnedEmission learned;                       ///< of the last round
    std::size_t trainPaths = 0, heldOutPaths = 0;  ///< of all rounds
};

/// From about `paths` paths. `aspect`: width over height of the picture. Throws Error 130 once `cancel` is set.
EmissionTraining trainEmission(const Scene& scene, const Camera& camera, double aspect,
                               const WalkLimits& limits, std::uint64_t paths, std::uint64_t seed,
                               const ThreadPool& pool, const std::atomic<bool>& cancel);

}  // namespace lacuna
