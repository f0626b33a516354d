// The node hierarchy of the default scene, flattened.
#pragma once

#include <vector>

#include "libcore/base/vec.h"
#include "libcore/gltf/document.h"

namespace lacuna::gltf {

struct Placement {
    std::size_t node = 0;
    Affine toWorld;
    /// KHR_node_visibility of the node and all its ancestors. If false, its mesh and light are left out.
    bool visible = true;
};

/// Every node of the default scene once, parents before children, siblings in the file's order. A
/// file without scenes gets all its root nodes (with a warning). Throws InputError for cycles, a
/// node with two parents (or listed as a root and a child), and transforms that are not finite or
/// not affine.
std::vector<Placement> flattenScene(const Document& document, Warnings& warnings);

/// The transforms at which EXT_mesh_gpu_instancing places the mesh of `node`, in the node's own
/// coordinates; only the identity for a node without the extension. Throws InputError for
/// attributes of different lengths and transforms that are not finite.
std::vector<Affine> meshCopies(const Document& document, std::size_t node);

}  // namespace lacuna::gltf
