// scene.extras: `lacuna` (picture and lens) and `environment`; extras.lacuna of nodes and materials.
#pragma once

#include "libcore/gltf/document.h"
#include "libcore/scene/description.h"

namespace lacuna::gltf {

/// Fills width, height, maxDepth, aperture, focus and environment from the default scene's extras,
/// and hashes the environment's file. Either object may also be a string of JSON, as Blender writes
/// a property that was typed in. Unknown members get a warning (a misspelt one would otherwise
/// silently do nothing). Throws InputError for wrong types, values out of range, and an environment
/// that is not a .exr or .hdr file in the scene's folder or below it.
void readExtras(Document& document, SceneDescription& scene, Warnings& warnings);

/// The member `lacuna` of `extras`, which belong to the object at `place`: an object, also where it is given as a
/// string; empty where there is none. Throws InputError for anything else.
nlohmann::json lacunaExtras(const Document& document, const nlohmann::json& extras,
                            const std::string& place);
/// The member `light_group` of such an object; empty where it has none. Throws InputError unless it
/// is a non-empty string.
std::string lightGroupOf(const Document& document, const nlohmann::json& lacuna,
                         const std::string& place);
/// The light group of a node, from its extras.lacuna.
std::string nodeGroup(const Document& document, std::size_t node);

}  // namespace lacuna::gltf
