// Turns glTF materials, with the extensions that are rendered, into the description's materials.
#pragma once

#include <vector>

#include "libcore/gltf/image.h"

namespace lacuna::gltf {

/// All materials of the file, in its order. Factors are clamped to their legal range with one
/// warning; effects that are not rendered yet get one warning per kind. Throws InputError for an
/// index of refraction below 1 (0 is KHR_materials_ior's total reflector) and an unknown alphaMode.
std::vector<Material> readMaterials(const Document& document, TextureTable& textures,
                                    Warnings& warnings);

}  // namespace lacuna::gltf
