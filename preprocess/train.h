// The work of lacuna-train, also for lacuna-render --prepare: classification, Q and Gamma of
// subspace-based connections [Su22 7].
#pragma once

#include "libcore/cache/subspace_file.h"
#include "libcore/subspace/gamma.h"
#include "libcore/subspace/training_settings.h"
#include "preprocess/collect_paths.h"
#include "preprocess/voxelize.h"

namespace lacuna {

struct TrainSettings : TrainingSettings {
    std::uint64_t seed = 1;
};

/// The inputs of subspaces. `emission`, `walks`: hashes of the guides that paths follow.
CacheStamp subspaceStamp(const Settings& sceneInputs, const Settings& viewInputs,
                         const TrainingSettings& settings, const std::string& emission,
                         const std::string& walks);

/// Quality of one of the two trees, compared with the nearest centroid.
struct TreeReport {
    std::size_t centroids = 0, samples = 0;
    double accuracy = 1.0, heldOutAccuracy = 1.0;
    int depth = 0;
    std::size_t leaves = 0;
    double nanoseconds = 0.0;  ///< time of a look-up
};

struct Trained {
    SubspaceFile file;
    TreeReport lightTree, eyeTree;
    GammaResult gamma;
    std::size_t trainPaths = 0, heldOutPaths = 0;
    std::uint64_t traced = 0, outliers = 0, pathBytes = 0;
    double emptyLight = 0.0;                         ///< share of light subspaces with Q = 0
    double emptyEye = 0.0;                           ///< share of eye subspaces without a path
    std::map<std::string, std::uint64_t> peakBytes;  ///< of the process, at each phase's end
};

/// Trains subspaces. `stamp`: the inputs of the result. Throws InterruptedError once `cancel` is
/// set.
Trained train(const Scene& scene, const TrainingView& view, const TrainSettings& settings,
              const CacheStamp& stamp, const ThreadPool& pool, const std::atomic<bool>& cancel,
              Phases& phases);

}  // namespace lacuna
