// Names of lights and objects in the scene's file, by which users refer to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna {

struct BakedScene;
struct SceneDescription;

/// Consecutive lights of Lights with the same names.
struct NamedLights {
    enum class Kind : std::uint8_t { Mesh, Lamp, Environment };
    Kind kind = Kind::Lamp;
    std::size_t count = 1;
    /// For an emissive mesh: the group that its node names, else that of its material, else the
    /// material's name. For any other lamp: the group that its node names, else the node's name,
    /// else its own. For the environment: `environment`. Empty if none of these has a name.
    std::string group;
    /// The node's name, then that of the material or the light, without empty ones.
    std::vector<std::string> names;
};
/// The names of all lights.
std::vector<NamedLights> namedLights(const SceneDescription& description, const BakedScene& baked,
                                     bool environment);

/// The names of an object; empty if it has none.
struct ObjectNames {
    std::string node, material;

    /// The names that are not empty.
    std::vector<std::string> all() const;
    friend bool operator==(const ObjectNames&, const ObjectNames&) = default;
};
/// The names by object.
std::vector<ObjectNames> objectNames(const SceneDescription& description, const BakedScene& baked);

}  // namespace lacuna
