// (theory.md, "Subspaces")
#include "preprocess/training_view.h"

#include <algorithm>
#include <cmath>

namespace lacuna {

TrainingView trainingView(const Camera& camera, double aspect, const WalkLimits& limits,
                          std::uint64_t paths) {
    aspect = std::clamp(aspect, 0.05, 20.0);
    // There are some paths per pixel and iteration, and more pixels for more paths, up to 256 x
    // 144.
    const double pixels = std::clamp(double(paths) / 16.0, 256.0, 36864.0);
    const int width = std::max(1, int(std::lround(std::sqrt(pixels * aspect))));
    const int height = std::max(1, int(std::lround(pixels / width)));
    return {camera.withFilm({width, height}), limits};
}

}  // namespace lacuna
