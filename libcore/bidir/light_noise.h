// How noisy groups of lights are, each and with each other: --light-noise. The variance of any mixture of
// the groups follows. (theory.md, "Layers of paths")
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/film_sum.h"

namespace lacuna {

/// Products of what two groups of lights add to a pixel, summed over a block's samples.
class LightProducts {
  public:
    /// `sampleIterations`: BlockPlan's.
    LightProducts(std::size_t groups, std::size_t pixels, std::uint64_t sampleIterations);

    /// An iteration: by group, by pixel. What stands behind the groups is ignored.
    void add(std::span<const std::vector<Rgb>> groups, const ThreadPool& threads);
    /// Sets the layers product.gAAgBB, A <= B: the mean over samples of the product of their means,
    /// each weighted by its iterations. The sample under way counts as it is.
    void setMeans(LayeredImage& image) const;
    void clear();

  private:
    std::vector<std::vector<Rgb>> now_;       // by group: sums over the sample under way
    std::vector<std::vector<Rgb>> products_;  // by pair, over those before, over their iterations
    std::uint64_t sampleIterations_, iterations_ = 0, inSample_ = 0;
};

/// "covariance.g00g01": of two groups by their numbers, the smaller one first.
std::string lightCovarianceLayer(std::size_t first, std::size_t second);
/// Of all pairs of so many groups, each once.
std::vector<std::string> lightCovarianceLayers(std::size_t groups);

/// Replaces the layers product.gAAgBB by the covariances of the means of `samples` samples; the means
/// are the layers `means`, one for each group (zero below two samples).
void setLightCovariances(LayeredImage& image, std::span<const std::string> means,
                         std::uint64_t samples);

}  // namespace lacuna
