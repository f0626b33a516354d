// Contributions of training paths, relative to what their pixels show, and without outliers [Su22 7.1].
// (theory.md, "Subspaces")
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

/// A picture's luminance: the mean over blocks of `block`^2 pixels, to which a small share of the
/// whole picture's mean is added.
class PixelScale {
  public:
    /// `image`: row-major; values that are not finite are left out.
    PixelScale(std::span<const Rgb> image, int width, int block);
    /// The scale that contributions to the pixel are divided by; zero where the picture is black.
    double of(std::uint32_t pixel) const { return blocks_[blockOf(pixel)]; }

  private:
    std::size_t blockOf(std::uint32_t pixel) const {
        const int x = int(pixel) % width_ / block_, y = int(pixel) / width_ / block_;
        return std::size_t(y) * std::size_t(columns_) + std::size_t(x);
    }

    int width_, block_, columns_;
    std::vector<double> blocks_;
};

/// The contribution whose square is a thousandth of the sum of squares, once all larger ones have
/// been lowered to it. Otherwise a loss on finitely many paths would follow those few alone.
float outlierLimit(std::span<const float> contributions);

}  // namespace lacuna
