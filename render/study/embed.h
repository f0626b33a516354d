// Pictures for embedding in a page: radiance as text, averaged over pixels to limit the size.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "libcore/image/image.h"

namespace lacuna {

/// Mean of all pixels and channels.
double meanOf(const Image& image);

/// Means over n x n pixels; the remainder at the right and lower edge is dropped.
Image shrunk(const Image& image, int n);
/// The least n for `shrunk` with which this number of pixels takes at most `bytes` as text.
int shrinkFactor(double pixels, double bytes);

/// The half floats of `image` times 2^stops in base64: little-endian, R G B, top row first.
std::string pixelsText(const Image& image, int stops);
/// The exponent for `pixelsText` that keeps pictures of this mean away from both ends of the range
/// of halves.
int stopsFor(double mean);

/// Base64 of RFC 4648.
std::string base64(std::string_view bytes);

}  // namespace lacuna
