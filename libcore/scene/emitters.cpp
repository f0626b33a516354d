// (theory.md, "Lights")
#include "libcore/scene/emitters.h"

#include <utility>

namespace lacuna {

namespace {

EmissiveTriangle emissiveTriangle(const SceneDescription& description, const BakedScene& baked,
                                  const SceneObject& object, std::uint32_t triangle, bool holes) {
    const BakedMesh& mesh = baked.meshes[object.mesh];
    const Material& material = description.materials[mesh.material];
    EmissiveTriangle e;
    e.corners = baked.corners(object, triangle);
    e.uvs = mesh.uvsOf(material.emissiveTexture, triangle);
    for (Vec2& uv : e.uvs) uv = material.emissiveTexture.at(uv);
    if (holes) e.alpha = alphaOf(description, mesh, triangle);
    if (object.turned()) {
        // The front is the image of the mesh's front. A mirrored instance still has the mesh's
        // winding; therefore two corners are swapped (and barycentrics at hits).
        std::swap(e.corners[1], e.corners[2]);
        std::swap(e.uvs[1], e.uvs[2]);
        if (e.alpha) {
            std::swap(e.alpha->uvs[1], e.alpha->uvs[2]);
            std::swap(e.alpha->corners[1], e.alpha->corners[2]);
        }
    }
    e.radiance = material.emission;
    if (const TextureUse& use = material.emissiveTexture) {
        e.texture = &description.textures[std::size_t(use.value)];
    }
    e.twoSided = material.doubleSided;
    e.hiddenFromCamera = material.hiddenFromCamera;
    e.material = mesh.material;
    return e;
}

}  // namespace

std::vector<EmissiveTriangle> emissiveTriangles(const SceneDescription& description,
                                                BakedScene& baked) {
    std::vector<EmissiveTriangle> emitters;
    for (SceneObject& object : baked.objects) {
        const BakedMesh& mesh = baked.meshes[object.mesh];
        const Material& material = description.materials[mesh.material];
        if (isBlack(material.emission)) continue;
        const bool holes = mayHaveHoles(material, description.textures, mesh.hasVertexAlpha());
        object.firstLight = std::uint32_t(emitters.size());
        for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
            emitters.push_back(emissiveTriangle(description, baked, object, k, holes));
        }
    }
    return emitters;
}

}  // namespace lacuna
