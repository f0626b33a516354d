// Learns directions of walks in rounds. (theory.md, "Guided walks")
#pragma once

#include <atomic>

#include "libcore/base/parallel.h"
#include "libcore/cache/cache_name.h"
#include "libcore/guide/learn_walks.h"
#include "preprocess/training_view.h"

namespace lacuna {

/// The inputs of a guide of walks. `paths`: number of training paths; `techniques`: of the guided
/// method; `emission`: hash of the guide by which light subpaths begin.
CacheStamp walkStamp(const Settings& sceneInputs, const Settings& viewInputs, std::uint64_t paths,
                     const Techniques& techniques, const std::string& emission);

struct WalkTraining {
    LearnedWalks learned;                          ///< by the last round
    std::size_t trainPaths = 0, heldOutPaths = 0;  ///< in all rounds
};

/// Learns from about `paths` paths. `aspect`: width over height of the picture; `lights`: guided,
/// or null; `techniques`: of the method to be guided. Throws InterruptedError once `cancel` is set.
WalkTraining trainWalks(const Scene& scene, const Camera& camera, double aspect,
                        const WalkLimits& limits, const std::shared_ptr<const Lights>& lights,
                        const Techniques& techniques, std::uint64_t paths, std::uint64_t seed,
                        const ThreadPool& pool, const std::atomic<bool>& cancel);

}  // namespace lacuna
