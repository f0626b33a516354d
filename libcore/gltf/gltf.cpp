#include "libcore/gltf/gltf.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <new>
#include <utility>
#include <vector>

#include "libcore/gltf/blender.h"
#include "libcore/gltf/document.h"
#include "libcore/gltf/entities.h"
#include "libcore/gltf/extras.h"
#include "libcore/gltf/image.h"
#include "libcore/gltf/in_parallel.h"
#include "libcore/gltf/limits.h"
#include "libcore/gltf/material.h"
#include "libcore/gltf/mesh.h"
#include "libcore/gltf/node.h"
#include "libcore/gltf/skin.h"
#include "libcore/scene/texture.h"

namespace lacuna {
namespace {

using namespace gltf;

/// Seconds since the last call (or construction).
class Stopwatch {
  public:
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const std::chrono::duration<double> passed = now - last_;
        last_ = now;
        return passed.count();
    }

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Adds a mesh that a skin deforms. Its joints place it, not its node.
void addBent(SkinnedMesh bent, Instance instance, SceneDescription& scene) {
    if (bent.mesh.triangles.empty()) return;
    instance.mesh = std::uint32_t(scene.meshes.size());
    instance.toWorld = bent.toWorld;
    scene.meshes.push_back(std::move(bent.mesh));
    scene.instances.push_back(instance);
}

/// Adds one instance per placed primitive and copy. Negative determinants stay in toWorld; with a
/// determinant of zero there is no surface to hit. `groupName`: name of the node's light group, or
/// empty.
void addInstances(Document& document, const Placement& placement, const MeshTable& table,
                  const SkinTable& skins, const std::string& groupName, SceneDescription& scene,
                  Warnings& warnings) {
    const Node& node = document.nodes[placement.node];
    const int mesh = node.mesh;
    if (mesh < 0) return;
    const std::string place = "nodes[" + std::to_string(placement.node) + "]";
    const bool hasSkin = node.skin >= 0;
    if (hasSkin) {
        warnings.add("skins are rendered at rest, as their joints' nodes stand", 1, place);
    }
    std::uint32_t group = Instance::kNoGroup;
    if (!groupName.empty()) {
        group = std::uint32_t(scene.nodeGroups.size());
        scene.nodeGroups.push_back(groupName);
    }
    std::uint32_t nodeName = Instance::kNoName;
    if (!node.name.empty()) {
        nodeName = std::uint32_t(scene.nodeNames.size());
        scene.nodeNames.push_back(node.name);
    }
    for (const Affine& copy : meshCopies(document, placement.node)) {
        const Affine toWorld = placement.toWorld * copy;
        const double determinant = toWorld.determinant();
        if (!std::isfinite(determinant)) {
            refuse(document.file, place, "a finite transform", "one that overflows",
                   "check the scales in the hierarchy");
        }
        if (determinant == 0.0) {
            warnings.add("objects scaled to nothing are left out", 1, place);
            continue;
        }
        for (const std::uint32_t index : table.ofPrimitive[std::size_t(mesh)]) {
            if (index == MeshTable::kNone) continue;
            if (scene.instances.size() >= Limits::kInstances) {
                refuse(document.file, place,
                       "at most " + std::to_string(Limits::kInstances) + " instances", "more",
                       "simplify the scene");
            }
            if (hasSkin && !table.influences[index].joints.empty()) {
                addBent(skins.bend(document, placement.node, scene.meshes[index],
                                   table.influences[index]),
                        {index, toWorld, group, nodeName}, scene);
                continue;
            }
            scene.instances.push_back({index, toWorld, group, nodeName});
        }
    }
}

/// Adds glTF's default material after the file's own if a primitive uses it: primitives without a
/// material have this index.
void addDefaultMaterial(SceneDescription& scene) {
    bool needed = scene.materials.empty();
    for (const Mesh& mesh : scene.meshes) needed |= mesh.material == scene.materials.size();
    if (!needed) return;
    scene.materials.emplace_back();
    scene.materials.back().name = "default";
}

/// Finds the smallest roughness in each material's textures.
void findLeastTexels(SceneDescription& scene) {
    constexpr std::pair<TextureUse Material::*, float Material::*> kOfRoughness[] = {
        {&Material::metallicRoughnessTexture, &Material::leastRoughnessTexel},
        {&Material::clearcoatRoughnessTexture, &Material::leastClearcoatRoughnessTexel}};
    std::map<std::int32_t, float> least;  // by texture: materials share them
    for (const Material& m : scene.materials) {
        for (const auto& [texture, texel] : kOfRoughness) {
            if (m.*texture) least[(m.*texture).value];
        }
    }
    std::vector<std::pair<const std::int32_t, float>*> textures;
    for (auto& entry : least) textures.push_back(&entry);
    inParallel(textures, [&](auto* entry) {
        entry->second = leastGreen(scene.textures[std::size_t(entry->first)]);
    });
    for (Material& m : scene.materials) {
        for (const auto& [texture, texel] : kOfRoughness) {
            if (m.*texture) m.*texel = least.at((m.*texture).value);
        }
    }
}

Bytes copyOf(std::span<const std::uint8_t> bytes) {
    Bytes copy{std::make_unique_for_overwrite<std::uint8_t[]>(bytes.size()), bytes.size()};
    std::copy(bytes.begin(), bytes.end(), copy.data.get());
    return copy;
}

/// Reads the scene. `bytes` returns the file's content and is called once.
void load(const std::string& path, const std::function<Bytes()>& bytes, SceneDescription& scene,
          Warnings& warnings) {
    Stopwatch watch;
    Document document;
    loadDocument(path, bytes(), document, warnings);
    warnings.add("animations are ignored: the scene is rendered at rest",
                 document.json.contains("animations"));
    const std::vector<Placement> placements = flattenScene(document, warnings);
    TextureTable textures(document);
    scene.materials = readMaterials(document, textures, warnings);
    scene.phaseSeconds["parse"] = watch.lap();

    scene.textures = textures.decode(document);
    findLeastTexels(scene);
    readExtras(document, scene, warnings);
    scene.phaseSeconds["decode"] = watch.lap();

    std::vector<bool> used(document.model.meshes.size());
    for (const Placement& placement : placements) {
        const int mesh = document.nodes[placement.node].mesh;
        if (mesh >= 0 && placement.visible) used[std::size_t(mesh)] = true;
    }
    MeshTable table = readMeshes(document, used, warnings);
    const SkinTable skins(document, placements);
    scene.meshes = std::move(table.meshes);
    for (const Placement& placement : placements) {
        addCamera(document, placement.node, placement.toWorld, scene, warnings);
        if (!placement.visible) continue;
        const std::string group = nodeGroup(document, placement.node);
        addInstances(document, placement, table, skins, group, scene, warnings);
        addLight(document, placement.node, placement.toWorld, group, scene, warnings);
    }
    addDefaultMaterial(scene);
    scene.fromBlender = isFromBlender(document);
    warnAboutLighting(document, placements, scene.lampUnits, warnings);
    warnAboutBareMaterials(document, scene, warnings);
    scene.phaseSeconds["meshes"] = watch.lap();
    scene.contentHash = document.hash.hex();
}

SceneDescription loadBytes(const std::string& path, const std::function<Bytes()>& bytes,
                           LampUnits units) {
    SceneDescription scene;
    scene.file = path;
    scene.lampUnits = units;
    Warnings warnings;
    try {
        load(path, bytes, scene, warnings);
    } catch (const std::bad_alloc&) {
        refuse(path, "", "a scene that fits into memory", "a larger one", "simplify the scene");
    }
    scene.warnings = warnings.lines();
    return scene;
}

}  // namespace

SceneDescription loadGltf(const std::string& path, LampUnits units) {
    return loadBytes(
        path, [&] { return readFile(path, Limits::kFileBytes); }, units);
}

SceneDescription loadGltf(const std::string& name, std::span<const std::uint8_t> glb,
                          LampUnits units) {
    return loadBytes(
        name, [&] { return copyOf(glb); }, units);
}

void requireCamera(const SceneDescription& scene) {
    if (!scene.cameras.empty()) return;
    refuse(scene.file, "", "a perspective camera in the scene", "none",
           scene.fromBlender ? "add one and export again with Include > Cameras on, which Blender "
                               "leaves off"
                             : "add a camera and export again");
}

}  // namespace lacuna
