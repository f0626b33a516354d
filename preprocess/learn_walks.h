// Where walks go on to, learned in rounds. (theory.md, "Guided walks")
#pragma once

#include <atomic>

#include "libcore/base/parallel.h"
#include "libcore/cache/cache_name.h"
#include "libcore/guide/learn_walks.h"
#include "preprocess/training_view.h"

namespace lacuna {

/// What a guide of walks is made of: so many paths, for a method of these techniques; their light
/// subpaths began as `emission` (a hash) says.
CacheStamp walkStamp(const Settings& sceneInputs, const Settings& viewInputs, std::uint64_t paths,
                     const Techniques& techniques, const std::string& emission);

struct WalkTraining {
    LearnedWalks learned;                          ///< of the last round
    std::size_t trainPaths = 0, heldOutPaths = 0;  ///< of all rounds
};

/// From about `paths` paths. `aspect`: width over height of the picture; `lights`: guided, or null;
/// `techniques`: of the method that is to be guided.
/// Throws Error 130 once `cancel` is set.
WalkTraining trainWalks(const Scene& scene, const Camera& camera, double aspect,
                        const WalkLimits& limits, const std::shared_ptr<const Lights>& lights,
                        const Techniques& techniques, std::uint64_t paths, std::uint64_t seed,
                        const ThreadPool& pool, const std::atomic<bool>& cancel);

}  // namespace lacuna
