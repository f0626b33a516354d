// How training looks at a scene: as it is rendered.
#pragma once

#include <cstdint>
#include <memory>

#include "libcore/bidir/walk.h"
#include "libcore/scene/scene.h"

namespace lacuna {

struct TrainingView {
    Camera camera;
    WalkLimits limits;
    Guides guides = {};
};

/// The rendered camera with a small film for so many paths. `aspect`: width over height of the
/// picture.
TrainingView trainingView(const Camera& camera, double aspect, const WalkLimits& limits,
                          std::uint64_t paths);

/// Iterations of training: no render reaches them.
inline constexpr std::uint32_t kTrainingIteration = 0x80000000u;
inline constexpr std::uint32_t kEmissionIteration = 0xa0000000u;
inline constexpr std::uint32_t kWalkIteration = 0xb0000000u;

}  // namespace lacuna
