// Pixels as a row of numbers: red, green and blue of the first, then of the second, and so on.
#pragma once

#include <span>

#include "libcore/base/vec.h"

namespace lacuna {

/// `Pixel` is Rgb or const Rgb.
template <class Pixel>
auto channelsOf(std::span<Pixel> pixels) {
    static_assert(sizeof(Pixel) == 3 * sizeof(float));
    return std::span(&pixels.data()->r, 3 * pixels.size());
}

}  // namespace lacuna
