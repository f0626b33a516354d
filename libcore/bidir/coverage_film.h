// The picture's alpha: how often the eye paths of a pixel meet something before the environment.
#pragma once

#include <vector>

#include "libcore/bidir/film.h"
#include "libcore/bidir/render_setup.h"

namespace lacuna {

/// Sums over a block's iterations, by the first rays of their eye paths. These are the same for every method, so
/// an edge has the same share in alpha as in the picture. A ray that alpha and panes let pass to the environment
/// meets nothing.
class CoverageFilm final : public BlockLayers {
  public:
    CoverageFilm(int width, int height) : met_(std::size_t(width) * std::size_t(height)) {}

    void addIteration(const RenderSetup& setup, const Iteration& iteration);
    /// The channel A in [0, 1], row-major in the crop.
    Layers means() const override;
    void clear() override;

  private:
    std::vector<float> met_;  // by pixel: iterations whose ray met something, exact up to 2^24
    std::uint64_t iterations_ = 0;
};

}  // namespace lacuna
