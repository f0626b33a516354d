// glTF primitives as indexed triangles.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcore/gltf/document.h"
#include "libcore/scene/description.h"

namespace lacuna::gltf {

/// The joints that move the vertices of a mesh (JOINTS_0, WEIGHTS_0): up to four joints of a skin and their weights.
/// Empty for a mesh without a skin.
struct Influences {
    std::vector<std::array<float, 4>> joints, weights;
};

/// The meshes of the description, and the map from glTF primitives to them.
struct MeshTable {
    static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

    std::vector<Mesh> meshes;
    std::vector<Influences> influences;  ///< by mesh
    /// By glTF mesh and primitive: index into `meshes`, or kNone where nothing is left to draw.
    std::vector<std::vector<std::uint32_t>> ofPrimitive;
};

/// Drops the triangles without area and returns their number.
std::size_t dropFlatTriangles(Mesh& mesh);

/// Reads the primitives of the glTF meshes that `used` marks (one flag per mesh), in parallel.
/// Strips and fans are unrolled; points and lines are skipped and triangles without area dropped,
/// with one warning each. Morph targets move the vertices by their mesh's own weights. Primitives without a material
/// get index model.materials.size(). Throws the InputError of the first faulty primitive.
MeshTable readMeshes(const Document& document, const std::vector<bool>& used, Warnings& warnings);

}  // namespace lacuna::gltf
