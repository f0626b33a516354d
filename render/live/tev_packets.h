// What of tev's protocol a renderer needs. The viewer answers nothing.
//
// A packet is its length in bytes (32 bits, with these four), a byte that says what kind it is, and
// its fields one after the other: integers with the lowest byte first, floats the same way, texts
// with a zero byte behind them, a switch as a byte 0 or 1, lists without their length.
//
//   create image (4): switch: take the focus; name; width, height: 32 bits; number of channels: 32
//                     bits; their names
//   update image (6): switch; name; number of channels; their names; x, y, width, height of the
//                     tile; for each channel where its first value is among those that follow: 64
//                     bits; for each the distance from one pixel to the next: 64 bits; values
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/film.h"

namespace lacuna {

using Packet = std::vector<std::byte>;

/// An image as the viewer knows it.
struct TevImage {
    std::string name;
    int width = 0, height = 0;
    std::vector<std::string> channels;
};

/// A new image, black, in front of the others. It takes the place of one of the same name.
Packet createImage(const TevImage& image);

/// `planes`: the whole image, by channel.
Packet updateImage(const TevImage& image, const PixelRect& tile,
                   std::span<const std::vector<float>* const> planes);

/// What an image is sent in: rows of tiles of a bounded number of values, top to bottom.
std::vector<PixelRect> tilesOf(const TevImage& image);

}  // namespace lacuna
