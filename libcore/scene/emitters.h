// The lamps that are meshes: triangles with emissive materials.
#pragma once

#include <vector>

#include "libcore/scene/baked.h"
#include "libcore/scene/light.h"

namespace lacuna {

/// Those of all objects, object by object; sets the objects' SceneObject::firstLight. They refer to
/// materials and textures of `description`.
std::vector<EmissiveTriangle> emissiveTriangles(const SceneDescription& description,
                                                BakedScene& baked);

}  // namespace lacuna
