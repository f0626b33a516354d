#include "preprocess/collect_paths.h"

#include <utility>

#include "preprocess/collect_inl.h"

namespace lacuna {

CollectedPaths collectPaths(const Scene& scene, const TrainingView& view, const LightCells& cells,
                            std::uint64_t paths, std::uint64_t seed, const ThreadPool& pool,
                            const std::atomic<bool>& cancel) {
    Collected<TrainingPaths> found = collect<TrainingPaths>(
        scene, view, paths, seed, kTrainingIteration, pool, cancel,
        [&](TrainingPaths& set, const PathEvent& event, float contribution) {
            set.add(event.path, event.counts, cells, contribution, event.pixel);
        });
    CollectedPaths result{std::move(found.train), std::move(found.heldOut), found.traced, 0,
                          found.iterations};
    const float limit = result.train.outlierLimit();
    result.outliers = result.train.lowerTo(limit) + result.heldOut.lowerTo(limit);
    return result;
}

}  // namespace lacuna
