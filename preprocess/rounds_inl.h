// Training paths of guides, collected in rounds: each round follows the guide that the earlier ones
// have learned. Included by files that define their own kind of record. (theory.md, "Learned
// emission")
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "preprocess/collect_inl.h"

namespace lacuna {

struct Round {
    std::uint64_t paths;           ///< approximate number
    std::uint32_t firstIteration;  ///< beyond those that renders reach
};

/// The rounds for `paths` paths in total.
inline std::array<Round, 3> roundsOf(std::uint64_t paths, std::uint32_t firstIteration) {
    constexpr double kShares[] = {0.15, 0.25, 0.6};
    constexpr std::uint32_t kIterations = 0x1000;
    std::array<Round, 3> rounds;
    for (std::uint32_t i = 0; i < rounds.size(); ++i) {
        const auto wanted = std::uint64_t(std::llround(kShares[i] * double(paths)));
        rounds[i] = {std::max<std::uint64_t>(1, wanted), firstIteration + i * kIterations};
    }
    return rounds;
}

/// collect() for one round, with outliers lowered. Adds the numbers of paths to `training`.
template <class Set, class Training, class Add>
Collected<Set> collectRound(const Scene& scene, const TrainingView& view, const Round& round,
                            std::uint64_t seed, const ThreadPool& pool,
                            const std::atomic<bool>& cancel, Training& training, const Add& add) {
    Collected<Set> found =
        collect<Set>(scene, view, round.paths, seed, round.firstIteration, pool, cancel, add);
    const float limit = found.train.outlierLimit();
    found.train.lowerTo(limit);
    found.heldOut.lowerTo(limit);
    training.trainPaths += found.train.size();
    training.heldOutPaths += found.heldOut.size();
    return found;
}

}  // namespace lacuna
