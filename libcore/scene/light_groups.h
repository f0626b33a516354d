// Groups of lights by name, by which a picture can be decomposed.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/scene/scene_names.h"

namespace lacuna {

/// The group of every light (NamedLights::group). Lights without any name are in the group
/// `unnamed`.
struct LightGroups {
    std::vector<std::string> names;    ///< in the order of the groups' first lights
    std::vector<std::uint32_t> group;  ///< by index of the light: index into `names`
};
LightGroups lightGroups(std::span<const NamedLights> lights);

}  // namespace lacuna
