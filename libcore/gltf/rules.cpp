// A table of every value that the reader uses, and the check of a file against it.
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "libcore/gltf/guard.h"

namespace lacuna::gltf {
namespace {

using nlohmann::json;

enum class Shape : std::uint8_t {
    Array,
    Object,
    String,
    Bool,
    Number,
    Numbers,  ///< array of numbers, `length` of them
    Count,    ///< integer in [0, 2^53]
    Count32,  ///< integer in [0, 2^31): tinygltf keeps it in an int
    Index     ///< integer below the length of the array `target`
};

struct Rule {
    const char* path;  ///< members by name, `*` for every element or member
    Shape shape;
    std::size_t length = 0;
    const char* target = nullptr;
};

constexpr const char* kLights = "extensions/KHR_lights_punctual/lights";

constexpr Rule kRules[] = {
    {"asset", Shape::Object},
    {"asset/version", Shape::String},
    {"asset/minVersion", Shape::String},
    {"extensionsUsed", Shape::Array},
    {"extensionsUsed/*", Shape::String},
    {"extensionsRequired", Shape::Array},
    {"extensionsRequired/*", Shape::String},
    {"extensions", Shape::Object},

    {"buffers", Shape::Array},
    {"buffers/*", Shape::Object},
    {"buffers/*/uri", Shape::String},
    {"buffers/*/byteLength", Shape::Count},
    {"buffers/*/extensions", Shape::Object},
    {"buffers/*/extensions/EXT_meshopt_compression", Shape::Object},
    {"buffers/*/extensions/EXT_meshopt_compression/fallback", Shape::Bool},

    {"bufferViews", Shape::Array},
    {"bufferViews/*", Shape::Object},
    {"bufferViews/*/buffer", Shape::Index, 0, "buffers"},
    {"bufferViews/*/byteOffset", Shape::Count},
    {"bufferViews/*/byteLength", Shape::Count},
    {"bufferViews/*/byteStride", Shape::Count},
    {"bufferViews/*/extensions", Shape::Object},
    {"bufferViews/*/extensions/EXT_meshopt_compression", Shape::Object},
    {"bufferViews/*/extensions/EXT_meshopt_compression/buffer", Shape::Index, 0, "buffers"},
    {"bufferViews/*/extensions/EXT_meshopt_compression/byteOffset", Shape::Count},
    {"bufferViews/*/extensions/EXT_meshopt_compression/byteLength", Shape::Count},
    {"bufferViews/*/extensions/EXT_meshopt_compression/byteStride", Shape::Count},
    {"bufferViews/*/extensions/EXT_meshopt_compression/count", Shape::Count},
    {"bufferViews/*/extensions/EXT_meshopt_compression/mode", Shape::String},
    {"bufferViews/*/extensions/EXT_meshopt_compression/filter", Shape::String},

    {"accessors", Shape::Array},
    {"accessors/*", Shape::Object},
    {"accessors/*/bufferView", Shape::Index, 0, "bufferViews"},
    {"accessors/*/byteOffset", Shape::Count},
    {"accessors/*/componentType", Shape::Count32},
    {"accessors/*/normalized", Shape::Bool},
    {"accessors/*/count", Shape::Count},
    {"accessors/*/type", Shape::String},
    {"accessors/*/sparse", Shape::Object},
    {"accessors/*/sparse/count", Shape::Count32},
    {"accessors/*/sparse/indices", Shape::Object},
    {"accessors/*/sparse/indices/bufferView", Shape::Index, 0, "bufferViews"},
    {"accessors/*/sparse/indices/byteOffset", Shape::Count32},
    {"accessors/*/sparse/indices/componentType", Shape::Count32},
    {"accessors/*/sparse/values", Shape::Object},
    {"accessors/*/sparse/values/bufferView", Shape::Index, 0, "bufferViews"},
    {"accessors/*/sparse/values/byteOffset", Shape::Count32},

    {"meshes", Shape::Array},
    {"meshes/*", Shape::Object},
    {"meshes/*/weights", Shape::Array},
    {"meshes/*/weights/*", Shape::Number},
    {"meshes/*/primitives", Shape::Array},
    {"meshes/*/primitives/*", Shape::Object},
    {"meshes/*/primitives/*/mode", Shape::Count32},
    {"meshes/*/primitives/*/indices", Shape::Index, 0, "accessors"},
    {"meshes/*/primitives/*/material", Shape::Index, 0, "materials"},
    {"meshes/*/primitives/*/attributes", Shape::Object},
    {"meshes/*/primitives/*/attributes/*", Shape::Index, 0, "accessors"},
    {"meshes/*/primitives/*/extensions", Shape::Object},
    {"meshes/*/primitives/*/extensions/KHR_draco_mesh_compression", Shape::Object},
    {"meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/bufferView", Shape::Index, 0,
     "bufferViews"},
    {"meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/attributes", Shape::Object},
    {"meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/attributes/*", Shape::Count32},
    {"meshes/*/primitives/*/targets", Shape::Array},
    {"meshes/*/primitives/*/targets/*", Shape::Object},
    {"meshes/*/primitives/*/targets/*/*", Shape::Index, 0, "accessors"},

    {"nodes", Shape::Array},
    {"nodes/*", Shape::Object},
    {"nodes/*/name", Shape::String},
    {"nodes/*/children", Shape::Array},
    {"nodes/*/children/*", Shape::Index, 0, "nodes"},
    {"nodes/*/mesh", Shape::Index, 0, "meshes"},
    {"nodes/*/camera", Shape::Index, 0, "cameras"},
    {"nodes/*/skin", Shape::Index, 0, "skins"},
    {"nodes/*/matrix", Shape::Numbers, 16},
    {"nodes/*/translation", Shape::Numbers, 3},
    {"nodes/*/rotation", Shape::Numbers, 4},
    {"nodes/*/scale", Shape::Numbers, 3},
    {"nodes/*/extensions", Shape::Object},
    {"nodes/*/extensions/KHR_lights_punctual", Shape::Object},
    {"nodes/*/extensions/KHR_lights_punctual/light", Shape::Index, 0, kLights},
    {"nodes/*/extensions/KHR_node_visibility", Shape::Object},
    {"nodes/*/extensions/KHR_node_visibility/visible", Shape::Bool},
    {"nodes/*/extensions/EXT_mesh_gpu_instancing", Shape::Object},
    {"nodes/*/extensions/EXT_mesh_gpu_instancing/attributes", Shape::Object},
    {"nodes/*/extensions/EXT_mesh_gpu_instancing/attributes/*", Shape::Index, 0, "accessors"},

    {"scene", Shape::Index, 0, "scenes"},
    {"scenes", Shape::Array},
    {"scenes/*", Shape::Object},
    {"scenes/*/nodes", Shape::Array},
    {"scenes/*/nodes/*", Shape::Index, 0, "nodes"},

    {"materials", Shape::Array},
    {"materials/*", Shape::Object},
    {"materials/*/name", Shape::String},
    {"materials/*/doubleSided", Shape::Bool},
    {"materials/*/alphaMode", Shape::String},
    {"materials/*/alphaCutoff", Shape::Number},
    {"materials/*/emissiveFactor", Shape::Numbers, 3},
    {"materials/*/emissiveTexture", Shape::Object},
    {"materials/*/emissiveTexture/index", Shape::Index, 0, "textures"},
    {"materials/*/emissiveTexture/texCoord", Shape::Count32},
    {"materials/*/normalTexture", Shape::Object},
    {"materials/*/normalTexture/index", Shape::Index, 0, "textures"},
    {"materials/*/normalTexture/texCoord", Shape::Count32},
    {"materials/*/normalTexture/scale", Shape::Number},
    {"materials/*/occlusionTexture", Shape::Object},
    {"materials/*/occlusionTexture/index", Shape::Index, 0, "textures"},
    {"materials/*/pbrMetallicRoughness", Shape::Object},
    {"materials/*/pbrMetallicRoughness/baseColorFactor", Shape::Numbers, 4},
    {"materials/*/pbrMetallicRoughness/metallicFactor", Shape::Number},
    {"materials/*/pbrMetallicRoughness/roughnessFactor", Shape::Number},
    {"materials/*/pbrMetallicRoughness/baseColorTexture", Shape::Object},
    {"materials/*/pbrMetallicRoughness/baseColorTexture/index", Shape::Index, 0, "textures"},
    {"materials/*/pbrMetallicRoughness/baseColorTexture/texCoord", Shape::Count32},
    {"materials/*/pbrMetallicRoughness/metallicRoughnessTexture", Shape::Object},
    {"materials/*/pbrMetallicRoughness/metallicRoughnessTexture/index", Shape::Index, 0,
     "textures"},
    {"materials/*/pbrMetallicRoughness/metallicRoughnessTexture/texCoord", Shape::Count32},
    {"materials/*/extensions", Shape::Object},
    {"materials/*/extensions/*", Shape::Object},
    {"materials/*/extensions/KHR_materials_transmission/transmissionTexture", Shape::Object},
    {"materials/*/extensions/KHR_materials_transmission/transmissionTexture/index", Shape::Index, 0,
     "textures"},
    {"materials/*/extensions/KHR_materials_transmission/transmissionTexture/texCoord",
     Shape::Count32},
    {"materials/*/extensions/KHR_materials_clearcoat/clearcoatTexture", Shape::Object},
    {"materials/*/extensions/KHR_materials_clearcoat/clearcoatTexture/index", Shape::Index, 0,
     "textures"},
    {"materials/*/extensions/KHR_materials_clearcoat/clearcoatTexture/texCoord", Shape::Count32},
    {"materials/*/extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture", Shape::Object},
    {"materials/*/extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture/index", Shape::Index,
     0, "textures"},
    {"materials/*/extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture/texCoord",
     Shape::Count32},
    {"materials/*/extensions/KHR_materials_clearcoat/clearcoatNormalTexture", Shape::Object},
    {"materials/*/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/index", Shape::Index, 0,
     "textures"},
    {"materials/*/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/texCoord",
     Shape::Count32},
    {"materials/*/extensions/KHR_materials_sheen/sheenColorTexture", Shape::Object},
    {"materials/*/extensions/KHR_materials_sheen/sheenColorTexture/index", Shape::Index, 0,
     "textures"},
    {"materials/*/extensions/KHR_materials_sheen/sheenColorTexture/texCoord", Shape::Count32},
    {"materials/*/extensions/KHR_materials_sheen/sheenRoughnessTexture", Shape::Object},
    {"materials/*/extensions/KHR_materials_sheen/sheenRoughnessTexture/index", Shape::Index, 0,
     "textures"},
    {"materials/*/extensions/KHR_materials_sheen/sheenRoughnessTexture/texCoord", Shape::Count32},
    {"materials/*/extensions/KHR_materials_anisotropy/anisotropyTexture", Shape::Object},
    {"materials/*/extensions/KHR_materials_anisotropy/anisotropyTexture/index", Shape::Index, 0,
     "textures"},
    {"materials/*/extensions/KHR_materials_anisotropy/anisotropyTexture/texCoord", Shape::Count32},
    {"materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture",
     Shape::Object},
    {"materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture/index",
     Shape::Index, 0, "textures"},
    {"materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture/"
     "texCoord",
     Shape::Count32},
    {"materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture",
     Shape::Object},
    {"materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture/"
     "index",
     Shape::Index, 0, "textures"},
    {"materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture/"
     "texCoord",
     Shape::Count32},
    {"materials/*/extensions/KHR_materials_specular/specularTexture", Shape::Object},
    {"materials/*/extensions/KHR_materials_specular/specularTexture/index", Shape::Index, 0,
     "textures"},
    {"materials/*/extensions/KHR_materials_specular/specularTexture/texCoord", Shape::Count32},
    {"materials/*/extensions/KHR_materials_specular/specularColorTexture", Shape::Object},
    {"materials/*/extensions/KHR_materials_specular/specularColorTexture/index", Shape::Index, 0,
     "textures"},
    {"materials/*/extensions/KHR_materials_specular/specularColorTexture/texCoord", Shape::Count32},

    {"textures", Shape::Array},
    {"textures/*", Shape::Object},
    {"textures/*/source", Shape::Index, 0, "images"},
    {"textures/*/sampler", Shape::Index, 0, "samplers"},
    {"textures/*/extensions", Shape::Object},
    {"textures/*/extensions/EXT_texture_webp", Shape::Object},
    {"textures/*/extensions/EXT_texture_webp/source", Shape::Index, 0, "images"},
    {"images", Shape::Array},
    {"images/*", Shape::Object},
    {"images/*/uri", Shape::String},
    {"images/*/bufferView", Shape::Index, 0, "bufferViews"},
    {"samplers", Shape::Array},
    {"samplers/*", Shape::Object},
    {"samplers/*/magFilter", Shape::Count32},
    {"samplers/*/wrapS", Shape::Count32},
    {"samplers/*/wrapT", Shape::Count32},

    {"cameras", Shape::Array},
    {"cameras/*", Shape::Object},
    {"cameras/*/name", Shape::String},
    {"cameras/*/type", Shape::String},
    {"cameras/*/perspective", Shape::Object},
    {"cameras/*/perspective/yfov", Shape::Number},
    {"cameras/*/perspective/aspectRatio", Shape::Number},

    {"extensions/KHR_lights_punctual", Shape::Object},
    {"extensions/KHR_lights_punctual/lights", Shape::Array},
    {"extensions/KHR_lights_punctual/lights/*", Shape::Object},
    {"extensions/KHR_lights_punctual/lights/*/type", Shape::String},
    {"extensions/KHR_lights_punctual/lights/*/color", Shape::Numbers, 3},
    {"extensions/KHR_lights_punctual/lights/*/intensity", Shape::Number},
    {"extensions/KHR_lights_punctual/lights/*/range", Shape::Number},
    {"extensions/KHR_lights_punctual/lights/*/spot", Shape::Object},
    {"extensions/KHR_lights_punctual/lights/*/spot/innerConeAngle", Shape::Number},
    {"extensions/KHR_lights_punctual/lights/*/spot/outerConeAngle", Shape::Number},

    {"animations", Shape::Array},
    {"skins", Shape::Array},
    {"skins/*", Shape::Object},
    {"skins/*/joints", Shape::Array},
    {"skins/*/joints/*", Shape::Index, 0, "nodes"},
    {"skins/*/inverseBindMatrices", Shape::Index, 0, "accessors"},
};

/// The path from a value up to the root. It becomes text only when a message needs it.
struct Trail {
    const Trail* up;
    std::string_view key;  ///< empty: `index`
    std::size_t index;

    std::string text() const {
        const std::string front = up ? up->text() : "";
        if (key.empty()) return front + "[" + std::to_string(index) + "]";
        return (front.empty() ? "" : front + ".") + std::string(key);
    }
};

/// Length of the array `path` names, 0 if there is none.
std::size_t lengthOf(const json& root, std::string_view path) {
    const json* at = &root;
    while (!path.empty()) {
        const std::size_t slash = std::min(path.find('/'), path.size());
        if (!at->is_object()) return 0;
        const auto member = at->find(std::string(path.substr(0, slash)));
        if (member == at->end()) return 0;
        at = &*member;
        path.remove_prefix(std::min(slash + 1, path.size()));
    }
    return at->is_array() ? at->size() : 0;
}

bool isCount(const json& value, std::uint64_t most) {
    return value.is_number_unsigned() && value.get<std::uint64_t>() <= most;
}

bool isNumbers(const json& value, std::size_t length) {
    if (!value.is_array() || value.size() != length) return false;
    for (const json& entry : value) {
        if (!entry.is_number()) return false;
    }
    return true;
}

class Walk {
  public:
    Walk(const std::string& file, const json& root, const Rule& rule)
        : file_(file), rule_(rule), targetLength_(rule.target ? lengthOf(root, rule.target) : 0) {}

    /// Checks every value below `node` that the rest of the rule's path leads to, and returns whether
    /// there is one. If a container on the way has the wrong type, the container's own rule reports it.
    bool visit(const json& node, std::string_view path, const Trail* trail) const {
        if (path.empty()) {
            check(node, *trail);
            return true;
        }
        const std::size_t slash = std::min(path.find('/'), path.size());
        const std::string_view name = path.substr(0, slash);
        const std::string_view rest = path.substr(std::min(slash + 1, path.size()));
        bool found = false;
        if (name == "*" && node.is_array()) {
            for (std::size_t i = 0; i < node.size(); ++i) {
                const Trail next{trail, {}, i};
                found |= visit(node[i], rest, &next);
            }
        } else if (name == "*" && node.is_object()) {
            for (auto member = node.begin(); member != node.end(); ++member) {
                const Trail next{trail, member.key(), 0};
                found |= visit(*member, rest, &next);
            }
        } else if (node.is_object()) {
            const auto member = node.find(name);
            if (member == node.end()) return false;
            const Trail next{trail, name, 0};
            found = visit(*member, rest, &next);
        }
        return found;
    }

  private:
    void check(const json& value, const Trail& trail) const {
        constexpr std::uint64_t kMost = 1ull << 53;
        constexpr std::uint64_t kMost32 = std::numeric_limits<std::int32_t>::max();
        bool right = false;
        const char* expected = "";
        switch (rule_.shape) {
            case Shape::Array:
                right = value.is_array(), expected = "an array";
                break;
            case Shape::Object:
                right = value.is_object(), expected = "an object";
                break;
            case Shape::String:
                right = value.is_string(), expected = "a string";
                break;
            case Shape::Bool:
                right = value.is_boolean(), expected = "true or false";
                break;
            case Shape::Number:
                right = value.is_number(), expected = "a number";
                break;
            case Shape::Numbers:
                right = isNumbers(value, rule_.length);
                break;
            case Shape::Count:
                right = isCount(value, kMost), expected = "a non-negative integer";
                break;
            case Shape::Count32:
                right = isCount(value, kMost32), expected = "a non-negative integer";
                break;
            case Shape::Index:
                right = isCount(value, kMost32) && value.get<std::uint64_t>() < targetLength_;
                break;
        }
        if (right) return;
        std::string sentence = expected;
        if (rule_.shape == Shape::Numbers) sentence = std::to_string(rule_.length) + " numbers";
        if (rule_.shape == Shape::Index) {
            sentence =
                "an index below " + std::to_string(targetLength_) + " (" + rule_.target + ")";
        }
        refuse(file_, trail.text(), sentence, found(value));
    }

    static std::string found(const json& value) {
        if (value.is_structured()) {
            return "an " + std::string(value.type_name()) + " of " + std::to_string(value.size());
        }
        return printable(value.dump(), 60);
    }

    const std::string& file_;
    const Rule& rule_;
    std::size_t targetLength_;
};

}  // namespace

void checkRules(const std::string& file, const json& root) {
    // Nothing lies below a path that leads nowhere: a million nodes without extensions are searched for
    // these once, not for the members of each.
    std::vector<std::string_view> absent;
    for (const Rule& rule : kRules) {
        const std::string_view path = rule.path;
        const auto isAbove = [path](std::string_view other) {
            return path.starts_with(other) && path.substr(other.size()).starts_with('/');
        };
        if (std::ranges::any_of(absent, isAbove)) continue;
        if (!Walk(file, root, rule).visit(root, path, nullptr)) absent.push_back(path);
    }
}

}  // namespace lacuna::gltf
