// The pictures of a page: radiance that a browser can expose anew, small enough to be embedded.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "render/study/results.h"

namespace lacuna {

/// Per scene {"width", "height", "shrink", "stops", "pictures": [{"name", "method" (index, -1: the
/// reference), "seed", "pixels"}]}: the reference and every method's picture of the first seed.
/// `pixels` are halves times 2^stops in base64 (little endian, R G B, top row first), averaged over
/// shrink x shrink pixels, so that all of a page are below kPictureBytes. Throws InputError for an
/// image that cannot be read.
nlohmann::json picturesJson(const Results& results);

inline constexpr double kPictureBytes = 20e6;

/// Means over n x n pixels; what is left over at the right and lower edge is dropped.
Image shrunk(const Image& image, int n);
/// RFC 4648.
std::string base64(std::string_view bytes);

}  // namespace lacuna
