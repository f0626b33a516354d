// The pictures of a page: radiance, which a browser can expose anew, small enough to be embedded.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "render/study/results.h"

namespace lacuna {

/// For each scene {"width", "height", "shrink", "stops", "pictures", "crops", "techniques"}.
/// `pictures`: the reference and every method's picture of the first seed, each {"name", "method"
/// (index, -1: the reference), "seed", "pixels"}. `pixels`: pixelsText of means over shrink x
/// shrink pixels, such that all pictures of a page take less than kPictureBytes. `crops`: for each
/// crop {"name", "rect": [x, y, width, height]} (before shrinking) and the same members as for the
/// scene. A crop's pictures also have "errors" by measure over all their pixels; null if not
/// finite. `techniques`: see techniquesJson. Throws InputError for an image that cannot be read.
nlohmann::json picturesJson(const Results& results);

inline constexpr double kPictureBytes = 12e6;
inline constexpr double kCropBytes = 4e6;

}  // namespace lacuna
