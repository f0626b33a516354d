// Layers of the contributions of some paths: --light-groups and --layer.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libcore/bidir/film.h"
#include "libcore/bidir/light_noise.h"
#include "libcore/bidir/path_layers.h"

namespace lacuna {

class ThreadPool;

/// Contributions by the layers that they belong to, summed over a block's iterations. means() has all
/// layers, black ones too.
class LayerFilm final : public BlockLayers {
  public:
    /// `layers` must outlive the film. `noiseSample` is the number of iterations (BlockPlan's) in a
    /// sample, if the noise of light groups is asked for, and else 0.
    LayerFilm(const PathLayers& layers, int width, int height, std::uint64_t noiseSample = 0);

    const PathLayers& layers() const { return layers_; }
    /// Different pixels may be added to at the same time.
    void add(const PathLayers::Share& share, std::uint32_t pixel) {
        now_[share.layer][pixel] += share.value;
    }
    void countIteration(const ThreadPool& threads);
    Layers means() const override;
    void clear() override;

  private:
    const PathLayers& layers_;
    int width_, height_;
    // By layer: the sums of the current iteration, and of those before. In a single sum the brightest splat of a pixel
    // would round off what later ones add to it.
    std::vector<std::vector<Rgb>> now_, sums_;
    std::optional<LightProducts> products_;
    std::uint64_t iterations_ = 0;
};

}  // namespace lacuna
