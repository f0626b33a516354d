// Skins at rest: vertices that follow several nodes.
#pragma once

#include "libcore/gltf/mesh.h"
#include "libcore/gltf/node.h"

namespace lacuna::gltf {

/// A mesh as its skin bends it, and where that lies.
struct SkinnedMesh {
    Mesh mesh;
    Affine toWorld;
};

/// The skins of a document, for one file's nodes where flattenScene put them.
class SkinTable {
  public:
    SkinTable(const Document& document, const std::vector<Placement>& placements);

    /// `mesh`, whose vertices are led by `influences`, as the skin of `node` (which has one) bends it.
    /// Triangles that are left without area are gone. Takes the memory from the document's allowance.
    /// Throws InputError for joints that do not exist or are not in the scene, for matrices that are
    /// not finite, and where the memory is used up.
    SkinnedMesh bend(Document& document, std::size_t node, const Mesh& mesh,
                     const Influences& influences) const;

  private:
    std::vector<Affine> jointTransforms(const Document& document, std::size_t skin) const;

    static constexpr std::size_t kNowhere = ~std::size_t(0);
    const std::vector<Placement>& placements_;
    std::vector<std::size_t> placementOf_;  ///< by node
};

}  // namespace lacuna::gltf
