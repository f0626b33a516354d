// The view of a scene for training: that of the render.
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

/// The rendered camera with a small film, whose size depends on the number of paths. `aspect`:
/// width over height of the picture.
TrainingView trainingView(const Camera& camera, double aspect, const WalkLimits& limits,
                          std::uint64_t paths);

/// First iterations of training; renders do not reach them.
inline constexpr std::uint32_t kTrainingIteration = 0x80000000u;
inline constexpr std::uint32_t kEmissionIteration = 0xa0000000u;
inline constexpr std::uint32_t kWalkIteration = 0xb0000000u;

}  // namespace lacuna
