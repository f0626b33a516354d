// Cameras and punctual lights of nodes.
#pragma once

#include "libcore/base/vec.h"
#include "libcore/gltf/document.h"
#include "libcore/scene/description.h"

namespace lacuna::gltf {

/// Adds the camera that `node` carries, if any, to scene.cameras. Orthographic cameras are skipped
/// with a warning. Throws InputError for impossible angles. toWorld keeps the node's scale: as in
/// any rasteriser, a uniform scale does not change the picture.
void addCamera(const Document& document, std::size_t node, const Affine& toWorld,
               SceneDescription& scene, Warnings& warnings);

/// The factor by which exporters turn W/sr and W/m^2 into candela and lux.
inline constexpr double kLumensPerWatt = 683.0;

/// The KHR_lights_punctual light that `node` carries, or null.
const tinygltf::Light* lightOf(const Document& document, std::size_t node);

/// Adds the KHR_lights_punctual light that `node` carries, if any, to scene.lights, converted from scene.lampUnits.
/// `group`: name of the node's light group, or empty. The node's scale does not change the light. Throws InputError for
/// impossible values.
void addLight(const Document& document, std::size_t node, const Affine& toWorld,
              const std::string& group, SceneDescription& scene, Warnings& warnings);

}  // namespace lacuna::gltf
