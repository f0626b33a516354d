// What lights and objects are called: by the scene's file, for people who name them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna {

struct BakedScene;
struct SceneDescription;

/// Lights that follow each other, as Lights counts them, and are called the same.
struct NamedLights {
    enum class Kind : std::uint8_t { Mesh, Lamp, Environment };
    Kind kind = Kind::Lamp;
    std::size_t count = 1;
    /// A mesh that emits is in the group that its node names, else in that of its material, else in
    /// one of the material's name; any other lamp in the one that its node names, else in one of the
    /// node's name, else of its own; the environment in `environment`. Empty: none has a name.
    std::string group;
    /// Of the node, then the material's or the light's own, as far as it has them.
    std::vector<std::string> names;
};
/// All of them.
std::vector<NamedLights> namedLights(const SceneDescription& description, const BakedScene& baked,
                                     bool environment);

/// Empty where there is none.
struct ObjectNames {
    std::string node, material;

    /// Those that there are.
    std::vector<std::string> all() const;
    friend bool operator==(const ObjectNames&, const ObjectNames&) = default;
};
/// By object.
std::vector<ObjectNames> objectNames(const SceneDescription& description, const BakedScene& baked);

}  // namespace lacuna
