// Warnings of exports from Blender that differ from what the user meant, as far as the file shows
// it.
#pragma once

#include <vector>

#include "libcore/gltf/document.h"
#include "libcore/gltf/node.h"
#include "libcore/scene/description.h"

namespace lacuna::gltf {

/// Whether asset.generator names Blender.
bool isFromBlender(const Document& document);

/// The exporter's setting Data > Lighting. The reader expects Unitless: a lamp of P watts has P / 4
/// pi W/sr, a sun of P has P W/m^2. Standard multiplies by 683 lumens per watt; Raw does not divide
/// by 4 pi.
enum class BlenderLighting { Unitless, Standard, Raw };

/// The lighting mode that explains the lamps' intensities. Blender stores powers as floats, and the
/// exporter computes and writes in double. To undo the wrong conversion therefore gives a number
/// that is no float. The intensities are those of the file. The result is Unitless where they
/// contradict each other or tell nothing.
struct BlenderLamp {
    bool isSun;
    double intensity;
};
BlenderLighting lightingOf(const std::vector<BlenderLamp>& lamps);

/// Warns if the scene's punctual lights (`placements`) were exported as Standard but are not read
/// as photometric, or were exported as Raw.
void warnAboutLighting(const Document& document, const std::vector<Placement>& placements,
                       LampUnits units, Warnings& warnings);

/// Warns, by name, of materials in use whose pbrMetallicRoughness is absent or empty, from any
/// exporter: glTF's default is white metal. Blender writes such a material for every shader that is
/// neither Principled BSDF nor Emission, and no material for objects without one.
void warnAboutBareMaterials(const Document& document, const SceneDescription& scene,
                            Warnings& warnings);

}  // namespace lacuna::gltf
