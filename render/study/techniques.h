// The pyramid of techniques of a page: what every (s, t) adds to a method's picture.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "render/study/results.h"

namespace lacuna {

/// Of one scene {"width", "height", "shrink", "stops", "edges", "pyramids"}, null where the study
/// asks for none; `stops` as given. A pyramid per method: {"name", "iterations", "seed",
/// "command_line", "layers", "costs", "longer": what paths of more than `edges` edges add, as a share of the
/// picture's mean}. A layer is a technique that contributed, {"s", "t", "share", "pixels"}: what it
/// adds, weighted; `share` and `pixels` as in "longer" and pixelsText; "noise_share" and "noise" are
/// likewise of its standard deviation. "costs": "techniques" of the render's JSON. All shrunk so far that those
/// of all scenes are below kTechniqueBytes. Throws InputError for an image that cannot be read.
nlohmann::json techniquesJson(const Results& results, std::size_t scene, int stops);

inline constexpr double kTechniqueBytes = 6e6;

}  // namespace lacuna
