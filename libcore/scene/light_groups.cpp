#include "libcore/scene/light_groups.h"

#include <unordered_map>

#include "libcore/scene/baked.h"
#include "libcore/scene/description.h"

namespace lacuna {

namespace {

class Grouping {
  public:
    /// The next `lights` lights.
    void add(const std::string& name, std::size_t lights) {
        const auto [entry, isNew] = indices_.try_emplace(name, std::uint32_t(result_.names.size()));
        if (isNew) result_.names.push_back(name.empty() ? "unnamed" : name);
        result_.group.insert(result_.group.end(), lights, entry->second);
    }
    LightGroups finish() { return std::move(result_); }

  private:
    LightGroups result_;
    std::unordered_map<std::string, std::uint32_t> indices_;
};

}  // namespace

LightGroups lightGroups(const SceneDescription& description, const BakedScene& baked,
                        bool environment) {
    // In the order of Lights: triangles object by object, then the lamps without a surface, then what
    // is around the scene.
    Grouping grouping;
    for (const SceneObject& object : baked.objects) {
        if (object.firstLight == SceneObject::kNoLight) continue;
        const BakedMesh& mesh = baked.meshes[object.mesh];
        const Material& material = description.materials[mesh.material];
        const std::string& ofMaterial =
            material.lightGroup.empty() ? material.name : material.lightGroup;
        grouping.add(object.lightGroup == Instance::kNoGroup
                         ? ofMaterial
                         : description.nodeGroups[object.lightGroup],
                     mesh.triangles.size());
    }
    for (const PunctualLight& light : description.lights) grouping.add(light.group, 1);
    if (environment) grouping.add("environment", 1);
    return grouping.finish();
}

}  // namespace lacuna
