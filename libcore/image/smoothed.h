// Smoothed pictures, in which a pixel that is dark by chance does not count as a dark place.
// (theory.md, "auto", "Effort behind glass")
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace lacuna {

/// The mean over the 5 x 5 pixels around each pixel, as far as they lie in the picture. `picture` is row-major and not
/// empty.
template <class Pixel>
std::vector<Pixel> smoothed(std::span<const Pixel> picture, int width) {
    constexpr int kReach = 2;
    const int height = int(picture.size()) / width;
    std::vector<Pixel> result(picture.size());
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            Pixel sum{};
            int count = 0;
            for (int ny = std::max(0, y - kReach); ny <= std::min(height - 1, y + kReach); ++ny) {
                for (int nx = std::max(0, x - kReach); nx <= std::min(width - 1, x + kReach);
                     ++nx) {
                    sum += picture[std::size_t(ny) * std::size_t(width) + std::size_t(nx)];
                    ++count;
                }
            }
            result[std::size_t(y) * std::size_t(width) + std::size_t(x)] = sum * (1.0 / count);
        }
    }
    return result;
}

}  // namespace lacuna
