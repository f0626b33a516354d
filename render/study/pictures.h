// The pictures of a page: radiance that a browser can expose anew, small enough to be embedded.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "render/study/results.h"

namespace lacuna {

/// Per scene {"width", "height", "shrink", "stops", "pictures", "crops", "techniques"}.
/// `pictures`: the reference and every method's picture of the first seed, each {"name", "method"
/// (index, -1: the reference), "seed", "pixels"}. `pixels`: see pixelsText, of means over
/// shrink x shrink pixels, so that all of a page are below kPictureBytes.
/// `crops`: per crop {"name", "rect": [x, y, width, height]} (before shrinking) and the same
/// members as the scene; their pictures have "errors" by measure too, of all their pixels, null
/// where that is not finite. `techniques`: see techniquesJson. Throws InputError for an image that
/// cannot be read.
nlohmann::json picturesJson(const Results& results);

inline constexpr double kPictureBytes = 12e6;
inline constexpr double kCropBytes = 4e6;

}  // namespace lacuna
