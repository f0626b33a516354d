// The part of tev's protocol that a renderer needs. The viewer sends no answers.
//
// A packet consists of its length in bytes (32 bits, included in the length), a byte for its kind,
// and its fields one after the other: integers and floats are little-endian, texts end with a zero
// byte, a switch is a byte 0 or 1, and lists have no length.
//
//   create image (4): switch: take the focus; name; width, height: 32 bits; number of channels: 32
//                     bits; their names
//   update image (6): switch; name; number of channels; their names; x, y, width, height of the
//                     tile; for each channel the index of its first value in the values: 64
//                     bits; for each the distance from one pixel to the next: 64 bits; values
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/film.h"

namespace lacuna {

using Packet = std::vector<std::byte>;

/// An image in the viewer.
struct TevImage {
    std::string name;
    int width = 0, height = 0;
    std::vector<std::string> channels;
};

/// Creates a black image in front of the others. It replaces an image of the same name.
Packet createImage(const TevImage& image);

/// Updates one tile. `planes`: the whole image, by channel.
Packet updateImage(const TevImage& image, const PixelRect& tile,
                   std::span<const std::vector<float>* const> planes);

/// The tiles in which an image is sent, row by row from the top. Each has a bounded number of
/// values.
std::vector<PixelRect> tilesOf(const TevImage& image);

}  // namespace lacuna
