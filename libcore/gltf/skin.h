// Skins in the file's pose (without animation): vertices that follow several nodes.
#pragma once

#include "libcore/gltf/mesh.h"
#include "libcore/gltf/node.h"

namespace lacuna::gltf {

/// A mesh deformed by its skin, and its placement.
struct SkinnedMesh {
    Mesh mesh;
    Affine toWorld;
};

/// The skins of a document, for the placements of nodes that flattenScene returned.
class SkinTable {
  public:
    SkinTable(const Document& document, const std::vector<Placement>& placements);

    /// `mesh`, whose vertices follow `influences`, as deformed by the skin of `node` (which must have one). Triangles
    /// that lose their area are dropped. The memory comes from the document's allowance. Throws InputError for joints
    /// that do not exist or are not in the scene, for matrices that are not finite, and where the allowance is used up.
    SkinnedMesh bend(Document& document, std::size_t node, const Mesh& mesh,
                     const Influences& influences) const;

  private:
    std::vector<Affine> jointTransforms(const Document& document, std::size_t skin) const;

    static constexpr std::size_t kNowhere = ~std::size_t(0);
    const std::vector<Placement>& placements_;
    std::vector<std::size_t> placementOf_;  ///< by node
};

}  // namespace lacuna::gltf
