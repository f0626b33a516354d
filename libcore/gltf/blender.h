// What Blender's exporter makes of a scene although its user meant something else, where the file
// tells.
#pragma once

#include <vector>

#include "libcore/gltf/document.h"
#include "libcore/gltf/node.h"
#include "libcore/scene/description.h"

namespace lacuna::gltf {

/// Whether asset.generator names Blender.
bool isFromBlender(const Document& document);

/// The export's Data > Lighting. Ours is Unitless: a lamp of P watts has P / 4 pi W/sr, a sun of P
/// has P W/m^2. Standard multiplies by 683 lumens per watt, Raw does not divide by 4 pi.
enum class BlenderLighting { Unitless, Standard, Raw };

/// Blender keeps powers as floats, and the exporter computes and writes in double, so that undoing
/// the wrong conversion leaves what no float is. `intensities` as in the file; Unitless where they
/// contradict each other or say nothing.
struct BlenderLamp {
    bool isSun;
    double intensity;
};
BlenderLighting lightingOf(const std::vector<BlenderLamp>& lamps);

/// Warns of punctual lights of the scene (`placements`) that were exported as Standard and are not
/// read as photometric, or as Raw.
void warnAboutLighting(const Document& document, const std::vector<Placement>& placements,
                       LampUnits units, Warnings& warnings);

/// Warns, by name, of materials in use that have no pbrMetallicRoughness or an empty one, from any
/// exporter: glTF's default is white metal. Blender writes that of every shader that is neither
/// Principled BSDF nor Emission, and no material at all of objects without one.
void warnAboutBareMaterials(const Document& document, const SceneDescription& scene,
                            Warnings& warnings);

}  // namespace lacuna::gltf
