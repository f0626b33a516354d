// Lights by the names of their groups, so that a picture can be taken apart by them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/scene/scene_names.h"

namespace lacuna {

/// The group of every light, as NamedLights::group says it. Who has no name at all is in `unnamed`.
struct LightGroups {
    std::vector<std::string> names;    ///< in the order of the groups' first lights
    std::vector<std::uint32_t> group;  ///< by light, as Lights counts them: an index into `names`
};
LightGroups lightGroups(std::span<const NamedLights> lights);

}  // namespace lacuna
