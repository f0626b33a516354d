// Variances and covariances of groups of lights: --light-noise. They give the variance of any mixture of the groups.
// (theory.md, "Layers of paths")
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
    /// `sampleIterations` is BlockPlan::sampleIterations().
    LightProducts(std::size_t groups, std::size_t pixels, std::uint64_t sampleIterations);

    /// Adds an iteration: a plane of pixels for each group. Further planes behind
    /// these are ignored.
    void add(std::span<const std::vector<Rgb>> groups, const ThreadPool& threads);
    /// Sets the layers product.gAAgBB, A <= B: the mean over samples of the product of their means,
    /// each weighted by its iterations. The current sample counts with the iterations that it has.
    void setMeans(LayeredImage& image) const;
    void clear();

  private:
    std::vector<std::vector<Rgb>> now_;       // by group: sums over the current sample
    std::vector<std::vector<Rgb>> products_;  // by pair: of earlier samples, over their iterations
    std::uint64_t sampleIterations_, iterations_ = 0, inSample_ = 0;
};

/// Name of the layer of two groups' covariance, such as "covariance.g00g01"; first <= second.
std::string lightCovarianceLayer(std::size_t first, std::size_t second);
/// The names of the layers of all pairs of groups, each pair once.
std::vector<std::string> lightCovarianceLayers(std::size_t groups);

/// Replaces the layers product.gAAgBB by the covariances of the groups' means over `samples` samples. `means` are the
/// names of the layers with these means, one for each group. Covariances are zero below two samples.
void setLightCovariances(LayeredImage& image, std::span<const std::string> means,
                         std::uint64_t samples);

}  // namespace lacuna
