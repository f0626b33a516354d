// What some paths add to the picture, layer by layer: --light-groups and --layer.
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
    /// `layers` must outlive the film. `noiseSample`: so many iterations (BlockPlan's) are a sample
    /// that the noise of light groups is known by; 0: it is not asked for.
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
    // By layer: of the iteration under way, and over those before. One sum of all would round what a
    // splat adds to a pixel by what the brightest one has left there.
    std::vector<std::vector<Rgb>> now_, sums_;
    std::optional<LightProducts> products_;
    std::uint64_t iterations_ = 0;
};

}  // namespace lacuna
