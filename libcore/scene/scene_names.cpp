#include "libcore/scene/scene_names.h"

#include "libcore/scene/baked.h"
#include "libcore/scene/description.h"

namespace lacuna {

namespace {

const Material& materialOf(const SceneDescription& description, const BakedScene& baked,
                           const SceneObject& object) {
    return description.materials[baked.meshes[object.mesh].material];
}

ObjectNames namesOf(const SceneDescription& description, const BakedScene& baked,
                    const SceneObject& object) {
    const bool named = object.nodeName != Instance::kNoName;
    return {named ? description.nodeNames[object.nodeName] : "",
            materialOf(description, baked, object).name};
}

/// The light group of an emissive object.
std::string groupOf(const SceneDescription& description, const BakedScene& baked,
                    const SceneObject& object) {
    if (object.lightGroup != Instance::kNoGroup) return description.nodeGroups[object.lightGroup];
    const Material& material = materialOf(description, baked, object);
    return material.lightGroup.empty() ? material.name : material.lightGroup;
}

}  // namespace

std::vector<NamedLights> namedLights(const SceneDescription& description, const BakedScene& baked,
                                     bool environment) {
    // In the order of Lights: triangles object by object, then lamps without a surface, then the environment.
    std::vector<NamedLights> all;
    for (const SceneObject& object : baked.objects) {
        if (object.firstLight == SceneObject::kNoLight) continue;
        all.push_back({NamedLights::Kind::Mesh, baked.meshes[object.mesh].triangles.size(),
                       groupOf(description, baked, object),
                       namesOf(description, baked, object).all()});
    }
    for (const PunctualLight& light : description.lights) {
        all.push_back({NamedLights::Kind::Lamp, 1, light.group, light.names});
    }
    if (environment) all.push_back({NamedLights::Kind::Environment, 1, "environment", {}});
    return all;
}

std::vector<std::string> ObjectNames::all() const {
    std::vector<std::string> names;
    for (const std::string* name : {&node, &material}) {
        if (!name->empty()) names.push_back(*name);
    }
    return names;
}

std::vector<ObjectNames> objectNames(const SceneDescription& description, const BakedScene& baked) {
    std::vector<ObjectNames> names;
    for (const SceneObject& object : baked.objects) {
        names.push_back(namesOf(description, baked, object));
    }
    return names;
}

}  // namespace lacuna
