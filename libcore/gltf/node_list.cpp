#include "libcore/gltf/node_list.h"

#include <algorithm>
#include <utility>

namespace lacuna::gltf {
namespace {

using nlohmann::json;

/// The member `name`, or null if it is absent.
const json& memberOf(const json& object, const char* name) {
    static const json none;
    const auto member = object.find(name);
    return member == object.end() ? none : *member;
}

std::int32_t indexOf(const json& object, const char* name) {
    const json& index = memberOf(object, name);
    return index.is_null() ? Node::kNone : index.get<std::int32_t>();
}

Vec3d vectorOf(const json& object, const char* name, const Vec3d& standard) {
    const json& v = memberOf(object, name);
    return v.is_null() ? standard
                       : Vec3d{v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

void readExtensions(const json& extensions, Node& node) {
    node.light = indexOf(memberOf(extensions, "KHR_lights_punctual"), "light");
    const json& visible = memberOf(memberOf(extensions, "KHR_node_visibility"), "visible");
    node.visible = visible.is_null() || visible.get<bool>();
    const json& copies = memberOf(memberOf(extensions, "EXT_mesh_gpu_instancing"), "attributes");
    node.translations = indexOf(copies, "TRANSLATION");
    node.rotations = indexOf(copies, "ROTATION");
    node.scales = indexOf(copies, "SCALE");
}

Node readNode(json& source) {
    Node node;
    if (const auto name = source.find("name"); name != source.end()) {
        node.name = std::move(name->get_ref<std::string&>());
    }
    for (const json& child : memberOf(source, "children")) {
        node.children.push_back(child.get<std::int32_t>());
    }
    node.mesh = indexOf(source, "mesh");
    node.camera = indexOf(source, "camera");
    node.skin = indexOf(source, "skin");
    for (const json& entry : memberOf(source, "matrix")) node.matrix.push_back(entry.get<double>());
    node.translation = vectorOf(source, "translation", node.translation);
    node.scale = vectorOf(source, "scale", node.scale);
    if (const json& rotation = memberOf(source, "rotation"); !rotation.is_null()) {
        for (std::size_t i = 0; i < 4; ++i) node.rotation[i] = rotation[i].get<double>();
    }
    if (const json& extensions = memberOf(source, "extensions"); !extensions.is_null()) {
        readExtensions(extensions, node);
    }
    if (const auto extras = source.find("extras"); extras != source.end()) {
        node.extras = std::move(*extras);
    }
    return node;
}

}  // namespace

std::vector<Node> readNodes(json nodes) {
    std::vector<Node> result;
    result.reserve(nodes.size());
    for (json& node : nodes) {
        result.push_back(readNode(node));
        node = nullptr;  // of a million nodes the JSON takes hundreds of megabytes
    }
    return result;
}

}  // namespace lacuna::gltf
