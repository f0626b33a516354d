#include "libcore/gltf/node.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/number_text.h"
#include "libcore/gltf/accessor.h"

namespace lacuna::gltf {
namespace {

std::string placeOfNode(std::size_t node) {
    return "nodes[" + std::to_string(node) + "]";
}

bool isFinite(const Affine& a) {
    return std::all_of(a.m.begin(), a.m.end(), [](const Vec3d& c) { return lacuna::isFinite(c); });
}

Affine fromMatrix(const Document& document, std::size_t node, const std::vector<double>& m) {
    // The last row of a column-major matrix must be that of an affine map.
    constexpr double kTolerance = 1e-6;
    const double off =
        std::max({std::abs(m[3]), std::abs(m[7]), std::abs(m[11]), std::abs(m[15] - 1)});
    if (!(off <= kTolerance)) {
        refuse(document.file, placeOfNode(node) + ".matrix", "0, 0, 0, 1 as the last row",
               "a projective matrix");
    }
    return {{Vec3d{m[0], m[1], m[2]}, Vec3d{m[4], m[5], m[6]}, Vec3d{m[8], m[9], m[10]},
             Vec3d{m[12], m[13], m[14]}}};
}

Affine fromTrs(const Document& document, std::size_t index, const Node& node) {
    auto [x, y, z, w] = node.rotation;
    const double l = std::sqrt(x * x + y * y + z * z + w * w);
    if (!(l > 0.0) || !std::isfinite(l)) {
        refuse(document.file, placeOfNode(index) + ".rotation", "a unit quaternion",
               "one of length " + numberText(l));
    }
    x /= l, y /= l, z /= l, w /= l;
    Affine a;
    a.m[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
    a.m[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
    a.m[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
    a.m[0] *= node.scale.x;
    a.m[1] *= node.scale.y;
    a.m[2] *= node.scale.z;
    a.m[3] = node.translation;
    return a;
}

Affine localTransform(const Document& document, std::size_t index) {
    const Node& node = document.nodes[index];
    return node.matrix.empty() ? fromTrs(document, index, node)
                               : fromMatrix(document, index, node.matrix);
}

/// Flags of the nodes that are children. Refuses two parents and cycles, in any scene of the file.
std::vector<bool> checkForest(const Document& document) {
    const std::vector<Node>& nodes = document.nodes;
    std::vector<bool> isChild(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (const int child : nodes[i].children) {
            if (isChild[std::size_t(child)]) {
                refuse(document.file, placeOfNode(std::size_t(child)), "one parent",
                       "two (or the same twice)", "export the hierarchy as a tree");
            }
            isChild[std::size_t(child)] = true;
        }
    }
    // Each node has at most one parent, so that a node that no root leads to is on or below a
    // cycle.
    std::vector<bool> reached(nodes.size());
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!isChild[i]) open.push_back(i);
    }
    while (!open.empty()) {
        const std::size_t node = open.back();
        open.pop_back();
        reached[node] = true;
        for (const int child : nodes[node].children) open.push_back(std::size_t(child));
    }
    const auto lost = std::find(reached.begin(), reached.end(), false);
    if (lost != reached.end()) {
        refuse(document.file, placeOfNode(std::size_t(lost - reached.begin())), "a tree of nodes",
               "a cycle", "export the hierarchy as a tree");
    }
    return isChild;
}

std::vector<std::size_t> sceneRoots(const Document& document, std::vector<bool> isChild,
                                    Warnings& warnings) {
    std::vector<std::size_t> roots;
    if (document.model.scenes.empty()) {
        for (std::size_t i = 0; i < isChild.size(); ++i) {
            if (!isChild[i]) roots.push_back(i);
        }
        warnings.add("the file has no scene: all its nodes are rendered", roots.empty() ? 0 : 1);
        return roots;
    }
    for (const int node : document.model.scenes[document.scene].nodes) {
        const std::size_t root = std::size_t(node);
        if (isChild[root]) {
            refuse(document.file, "scenes[" + std::to_string(document.scene) + "].nodes",
                   "root nodes, once each", placeOfNode(root) + " again",
                   "export the hierarchy as a tree");
        }
        isChild[root] = true;  // a second listing would draw it twice
        roots.push_back(root);
    }
    return roots;
}

/// One attribute of EXT_mesh_gpu_instancing, as `components` floats per copy; empty if it is
/// absent. `count`: the number of copies, 0 while it is unknown.
std::vector<float> readCopies(const Document& document, std::int32_t accessor, const char* name,
                              int components, const std::string& place, std::size_t& count) {
    if (accessor == Node::kNone) return {};
    // Copies at one place are useless, and without bytes in the file nothing would bound their
    // number.
    if (document.model.accessors[std::size_t(accessor)].bufferView < 0) {
        refuse(document.file, place + "." + name, "an accessor with a buffer view", "none");
    }
    const AccessorView view = viewAccessor(document, accessor, components);
    if (count != 0 && view.count != count) {
        refuse(document.file, place + "." + name,
               std::to_string(count) + " elements, as many as the others have",
               std::to_string(view.count));
    }
    count = view.count;
    return readFloats(view);
}

Vec3d vectorAt(const std::vector<float>& from, std::size_t i) {
    return {from[3 * i], from[3 * i + 1], from[3 * i + 2]};
}

}  // namespace

std::vector<Affine> meshCopies(const Document& document, std::size_t node) {
    const Node& source = document.nodes[node];
    if (std::max({source.translations, source.rotations, source.scales}) == Node::kNone) {
        return {Affine{}};
    }
    const std::string place = placeOfNode(node) + ".extensions.EXT_mesh_gpu_instancing";
    std::size_t count = 0;
    const auto read = [&](std::int32_t accessor, const char* name, int components) {
        return readCopies(document, accessor, name, components, place, count);
    };
    const std::vector<float> moves = read(source.translations, "TRANSLATION", 3),
                             turns = read(source.rotations, "ROTATION", 4),
                             scales = read(source.scales, "SCALE", 3);
    if (count == 0) return {Affine{}};
    std::vector<Affine> copies;
    copies.reserve(count);
    Node copy;
    for (std::size_t i = 0; i < count; ++i) {
        if (!moves.empty()) copy.translation = vectorAt(moves, i);
        if (!turns.empty()) std::copy_n(&turns[4 * i], 4, copy.rotation.begin());
        if (!scales.empty()) copy.scale = vectorAt(scales, i);
        copies.push_back(fromTrs(document, node, copy));
        if (!isFinite(copies.back())) {
            refuse(document.file, place, "finite transforms",
                   "another one, of copy " + std::to_string(i));
        }
    }
    return copies;
}

std::vector<Placement> flattenScene(const Document& document, Warnings& warnings) {
    const std::vector<Node>& nodes = document.nodes;
    std::vector<std::size_t> roots = sceneRoots(document, checkForest(document), warnings);

    // An explicit stack instead of recursion: chains of nodes may be as long as the file.
    std::vector<Placement> result, open;
    for (auto root = roots.rbegin(); root != roots.rend(); ++root)
        open.push_back({*root, {}, true});
    while (!open.empty()) {
        Placement at = open.back();
        open.pop_back();
        at.visible = at.visible && nodes[at.node].visible;
        at.toWorld = at.toWorld * localTransform(document, at.node);
        if (!isFinite(at.toWorld) || !std::isfinite(at.toWorld.determinant())) {
            refuse(document.file, placeOfNode(at.node), "a finite transform", "one that overflows",
                   "check the scales in the hierarchy");
        }
        const std::vector<std::int32_t>& children = nodes[at.node].children;
        for (auto child = children.rbegin(); child != children.rend(); ++child) {
            open.push_back({std::size_t(*child), at.toWorld, at.visible});
        }
        result.push_back(at);
    }
    return result;
}

}  // namespace lacuna::gltf
