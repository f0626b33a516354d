// Pictures as a page holds them: radiance as text, averaged over pixels where it would be too much.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "libcore/image/image.h"

namespace lacuna {

/// Mean of all pixels and channels.
double meanOf(const Image& image);

/// Means over n x n pixels; what is left over at the right and lower edge is dropped.
Image shrunk(const Image& image, int n);
/// The least n for `shrunk` with which this many pixels take at most `bytes` as text.
int shrinkFactor(double pixels, double bytes);

/// Halves of `image` times 2^stops in base64: little endian, R G B, top row first.
std::string pixelsText(const Image& image, int stops);
/// Exponent for `pixelsText` that keeps pictures of this mean clear of both ends of what halves
/// hold.
int stopsFor(double mean);

/// RFC 4648.
std::string base64(std::string_view bytes);

}  // namespace lacuna
