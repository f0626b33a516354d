// The picture's alpha: how often the eye paths of a pixel meet something before the environment.
#pragma once

#include <vector>

#include "libcore/bidir/film.h"
#include "libcore/bidir/render_setup.h"

namespace lacuna {

/// Summed over a block's iterations, by the first rays of their eye paths, whatever the method makes
/// of these: an edge has the share in alpha that it has in the picture. What alpha and panes let
/// through to the environment is not met.
class CoverageFilm final : public BlockLayers {
  public:
    CoverageFilm(int width, int height) : met_(std::size_t(width) * std::size_t(height)) {}

    void addIteration(const RenderSetup& setup, const Iteration& iteration);
    /// The channel A.
    Layers means() const override;
    void clear() override;

  private:
    std::vector<float> met_;  // by pixel: iterations, exact up to 2^24
    std::uint64_t iterations_ = 0;
};

}  // namespace lacuna
