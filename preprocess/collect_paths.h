// D, the full paths that SPCBPT trains with, by bidirectional path tracing [Su22 7.1].
#pragma once

#include <atomic>

#include "libcore/base/parallel.h"
#include "libcore/bidir/walk.h"
#include "libcore/scene/scene.h"
#include "libcore/subspace/training_paths.h"

namespace lacuna {

struct CollectedPaths {
    TrainingPaths train, heldOut;  ///< contributions relative to their pixels
    std::uint64_t traced = 0;      ///< paths that carry something, with those left out
    std::uint64_t outliers = 0;    ///< of both sets: contributions lowered to the limit
    std::uint64_t iterations = 0;
};

/// How training looks at a scene: as it is rendered.
struct TrainingView {
    Camera camera;
    WalkLimits limits;
};

/// The rendered camera with a small film for so many paths. `aspect`: width over height of the
/// picture.
TrainingView trainingView(const Camera& camera, double aspect, const WalkLimits& limits,
                          std::uint64_t paths);

/// About `paths` paths that connections can make, or as many as a hundred iterations give; a tenth
/// of the pixels is held out. Random numbers are of iterations that no render reaches: what is
/// learned from these paths must not know those that it weighs. Throws Error 130 once `cancel` is
/// set.
CollectedPaths collectPaths(const Scene& scene, const TrainingView& view, const LightCells& cells,
                            std::uint64_t paths, std::uint64_t seed, const ThreadPool& pool,
                            const std::atomic<bool>& cancel);

/// The first iteration number of training.
inline constexpr std::uint32_t kTrainingIteration = 0x80000000u;

}  // namespace lacuna
