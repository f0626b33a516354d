// Mesh lights: triangles with emissive materials.
#pragma once

#include <vector>

#include "libcore/scene/baked.h"
#include "libcore/scene/light.h"

namespace lacuna {

/// The emissive triangles of all objects, object by object. Sets the objects'
/// SceneObject::firstLight. The triangles refer to materials and textures of `description`.
std::vector<EmissiveTriangle> emissiveTriangles(const SceneDescription& description,
                                                BakedScene& baked);

}  // namespace lacuna
