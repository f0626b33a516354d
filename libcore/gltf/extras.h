// scene.extras: `lacuna` (picture and lens) and `environment`.
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

}  // namespace lacuna::gltf
