// Cameras and punctual lights: what a node places besides meshes.
#pragma once

#include "libcore/base/vec.h"
#include "libcore/gltf/document.h"
#include "libcore/scene/description.h"

namespace lacuna::gltf {

/// Adds the camera that `node` carries, if any, to scene.cameras. Orthographic ones are skipped
/// with a warning. Throws InputError for impossible angles. toWorld keeps the node's scale: as in
/// any rasteriser, a uniform one does not change the picture.
void addCamera(const Document& document, std::size_t node, const Affine& toWorld,
               SceneDescription& scene, Warnings& warnings);

/// By which exporters make candela and lux of W/sr and W/m^2.
inline constexpr double kLumensPerWatt = 683.0;

/// The KHR_lights_punctual light that `node` carries, or null.
const tinygltf::Light* lightOf(const Document& document, std::size_t node);

/// Adds the KHR_lights_punctual light that `node` carries, if any, to scene.lights, from what
/// scene.lampUnits says it is in; `group`: what the node calls its group, or nothing. The node's scale
/// does not change the light. Throws InputError for impossible values.
void addLight(const Document& document, std::size_t node, const Affine& toWorld,
              const std::string& group, SceneDescription& scene, Warnings& warnings);

}  // namespace lacuna::gltf
