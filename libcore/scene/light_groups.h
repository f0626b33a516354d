// Lights by the names of their groups, so that a picture can be taken apart by them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lacuna {

struct BakedScene;
struct SceneDescription;

/// The group of every light. A mesh that emits is in the group that its node names, else in that of its
/// material, else in one of the material's name; any other lamp in the one that its node names, else in
/// one of the node's name, else of its own; the environment in `environment`. Who has no name at all is
/// in `unnamed`.
struct LightGroups {
    std::vector<std::string> names;    ///< in the order of the groups' first lights
    std::vector<std::uint32_t> group;  ///< by light, as Lights counts them: an index into `names`
};
LightGroups lightGroups(const SceneDescription& description, const BakedScene& baked,
                        bool environment);

}  // namespace lacuna
