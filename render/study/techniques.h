// The page's pyramids of techniques: the contribution of every (s, t) to a method's picture.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "render/study/results.h"

namespace lacuna {

/// For one scene {"width", "height", "shrink", "stops", "edges", "pyramids"}; null if the study does not request
/// techniques. `stops` as given. There is one pyramid per method: {"name", "iterations", "seed", "command_line",
/// "layers", "costs", "longer"}. "longer" is the contribution of paths of more than `edges` edges as a share of the
/// picture's mean. A layer is a technique that contributed, {"s", "t", "share", "pixels"}: "share" is its weighted
/// contribution as such a share, and "pixels" its pixelsText. "noise_share" and "noise" are the same for its standard
/// deviation. "costs": "techniques" of the render's JSON. Layers are shrunk so that those of all scenes take less than
/// kTechniqueBytes. Throws InputError for an image that cannot be read.
nlohmann::json techniquesJson(const Results& results, std::size_t scene, int stops);

inline constexpr double kTechniqueBytes = 6e6;

}  // namespace lacuna
