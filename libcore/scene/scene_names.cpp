#include "libcore/scene/scene_names.h"

#include "libcore/scene/baked.h"
#include "libcore/scene/description.h"

namespace lacuna {

namespace {

const Material& materialOf(const SceneDescription& description, const BakedScene& baked,
                           const SceneObject& object) {
    return description.materials[baked.meshes[object.mesh].material];
}

std::vector<std::string> namesOf(const SceneDescription& description, const BakedScene& baked,
                                 const SceneObject& object) {
    std::vector<std::string> names;
    if (object.nodeName != Instance::kNoName) {
        names.push_back(description.nodeNames[object.nodeName]);
    }
    const std::string& ofMaterial = materialOf(description, baked, object).name;
    if (!ofMaterial.empty()) names.push_back(ofMaterial);
    return names;
}

/// The light group of an object that emits.
std::string groupOf(const SceneDescription& description, const BakedScene& baked,
                    const SceneObject& object) {
    if (object.lightGroup != Instance::kNoGroup) return description.nodeGroups[object.lightGroup];
    const Material& material = materialOf(description, baked, object);
    return material.lightGroup.empty() ? material.name : material.lightGroup;
}

}  // namespace

std::vector<NamedLights> namedLights(const SceneDescription& description, const BakedScene& baked,
                                     bool environment) {
    // In the order of Lights: triangles object by object, then the lamps without a surface, then what
    // is around the scene.
    std::vector<NamedLights> all;
    for (const SceneObject& object : baked.objects) {
        if (object.firstLight == SceneObject::kNoLight) continue;
        all.push_back({NamedLights::Kind::Mesh, baked.meshes[object.mesh].triangles.size(),
                       groupOf(description, baked, object), namesOf(description, baked, object)});
    }
    for (const PunctualLight& light : description.lights) {
        all.push_back({NamedLights::Kind::Lamp, 1, light.group, light.names});
    }
    if (environment) all.push_back({NamedLights::Kind::Environment, 1, "environment", {}});
    return all;
}

std::vector<std::vector<std::string>> objectNames(const SceneDescription& description,
                                                  const BakedScene& baked) {
    std::vector<std::vector<std::string>> names;
    for (const SceneObject& object : baked.objects) {
        names.push_back(namesOf(description, baked, object));
    }
    return names;
}

}  // namespace lacuna
