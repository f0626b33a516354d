// scene.extras: `lacuna` (picture and lens) and `environment`; extras.lacuna of nodes and materials.
#pragma once

#include "libcore/gltf/document.h"
#include "libcore/scene/description.h"

namespace lacuna::gltf {

/// Fills width, height, maxDepth, aperture, focus and environment from the default scene's extras,
/// and hashes the environment's file. Either object may be a text of JSON as well, which is what
/// Blender writes of a property that was typed in. Unknown members get a warning (a misspelt one
/// would otherwise do nothing, silently). Throws InputError for wrong types, values out of range,
/// and an environment that is not a .exr or .hdr file in the scene's folder or below it.
void readExtras(Document& document, SceneDescription& scene, Warnings& warnings);

/// `lacuna` in the `extras` of what is at `place`: an object, or its text; empty where there is none.
/// Throws InputError for anything else.
nlohmann::json lacunaExtras(const Document& document, const nlohmann::json& extras,
                            const std::string& place);
/// `light_group` of such an object; empty where it names none. Throws InputError unless it is a text
/// with something in it.
std::string lightGroupOf(const Document& document, const nlohmann::json& lacuna,
                         const std::string& place);
/// The same of a node, from its extras.lacuna.
std::string nodeGroup(const Document& document, std::size_t node);

}  // namespace lacuna::gltf
