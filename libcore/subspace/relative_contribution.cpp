// (theory.md, "Subspaces")
#include "libcore/subspace/relative_contribution.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace lacuna {

namespace {
constexpr double kDarkness = 0.02;      // of the picture's mean, added to every pixel's
constexpr double kLargestShare = 1e-3;  // of the sum of squares that a path may have
}  // namespace

PixelScale::PixelScale(std::span<const Rgb> image, int width, int block)
    : width_(width), block_(block), columns_((width + block - 1) / block) {
    const int height = int(image.size()) / width;
    const int rows = (height + block - 1) / block;
    blocks_.assign(std::size_t(columns_) * std::size_t(rows), 0.0);
    std::vector<double> pixels(blocks_.size(), 0.0);
    double total = 0.0;
    for (std::uint32_t p = 0; p < image.size(); ++p) {
        const double value = double(mean(image[p]));
        if (!std::isfinite(value)) continue;
        blocks_[blockOf(p)] += value;
        pixels[blockOf(p)] += 1.0;
        total += value;
    }
    const double floor = kDarkness * total / double(image.size());
    for (std::size_t b = 0; b < blocks_.size(); ++b) blocks_[b] = blocks_[b] / pixels[b] + floor;
}

float outlierLimit(std::span<const float> contributions) {
    std::vector<double> squares;
    double rest = 0.0;  // sum of those that are not lowered
    for (const float c : contributions) {
        squares.push_back(double(c) * double(c));
        rest += squares.back();
    }
    std::sort(squares.begin(), squares.end(), std::greater<>());
    for (std::size_t lowered = 0; lowered < squares.size(); ++lowered) {
        // With so many lowered to L:  L = share (lowered L + rest).
        const double left = 1.0 - kLargestShare * double(lowered);
        if (!(left > 0.0)) break;
        const double limit = kLargestShare * rest / left;
        if (squares[lowered] <= limit) return float(std::sqrt(limit));
        rest -= squares[lowered];
    }
    // There are so few paths that each has a large share.
    return squares.empty() ? 0.0f : float(std::sqrt(squares[0]));
}

}  // namespace lacuna
