// The scene's meshes and objects for ray tracing: in float, relative to the centre of the bounding
// box.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/scene/alpha.h"
#include "libcore/scene/description.h"

namespace lacuna {

class ThreadPool;

/// A mesh for ray tracing. A mesh that is used once is in world space. Other meshes are in their
/// own space, moved to their centre, so that large offsets in the file cost no precision.
struct BakedMesh {
    std::vector<Vec3> positions;  // one more than there are vertices (accel.h)
    std::vector<Vec3> normals;
    std::vector<std::array<float, 4>> tangents;  // as in the file, in this mesh's space
    std::vector<Vec2> uvs, uvs1;
    std::vector<std::array<float, 4>> colors;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec3> faceNormals;  // of world-space meshes only; read at every hit
    std::uint32_t material = 0;
    bool plain = true;  ///< no vertex colours, no second set, no normal map or grain
    /// Textures of the BSDF that do not fit into the processor's nearer caches.
    std::vector<TextureUse> farTextures;

    /// The texture coordinates of a texture's set; may be empty.
    const std::vector<Vec2>& uvsOf(const TextureUse& use) const {
        return use.secondSet ? uvs1 : uvs;
    }
    /// These coordinates at the triangle's corners; zeros if there are none.
    std::array<Vec2, 3> uvsOf(const TextureUse& use, std::uint32_t triangle) const;
    Vec3 tangentAt(const std::array<std::uint32_t, 3>& t, float u, float v) const;
    /// Whether some vertex colours are translucent.
    bool hasVertexAlpha() const;
};

/// A placed mesh.
struct SceneObject {
    std::uint32_t mesh = 0;
    bool instanced = false;  ///< else the mesh is in world space
    bool mirrored = false;
    std::array<Vec3, 4> toWorld;                    // columns and translation
    std::array<Vec3, 3> normal;                     // columns of the transform of normals
    std::uint32_t firstLight = kNoLight;            ///< light of its first triangle, if it emits
    std::uint32_t lightGroup = Instance::kNoGroup;  ///< that of its instance
    std::uint32_t nodeName = Instance::kNoName;     ///< likewise

    static constexpr std::uint32_t kNoLight = 0xffffffffu;

    Vec3 point(Vec3 p) const {
        return toWorld[0] * p.x + toWorld[1] * p.y + toWorld[2] * p.z + toWorld[3];
    }
    Vec3 vector(Vec3 v) const { return toWorld[0] * v.x + toWorld[1] * v.y + toWorld[2] * v.z; }
    Vec3 normalTo(Vec3 n) const { return normal[0] * n.x + normal[1] * n.y + normal[2] * n.z; }
    /// Whether the front (the image of the mesh's front) is opposite to the side given by the order
    /// of the transformed corners.
    bool turned() const { return instanced && mirrored; }
};

struct BakedScene {
    Vec3d centre;         ///< centre of the file's bounding box: file coordinates = these + centre
    float radius = 0.0f;  ///< of the bounding sphere around the origin; 0 without geometry
    Vec3 halfSize;        ///< half the sides of the bounding box; zero without geometry
    std::size_t triangles = 0;  ///< counted once per instance
    std::vector<BakedMesh> meshes;
    std::vector<SceneObject> objects;

    /// World-space corners, in the mesh's order.
    std::array<Vec3, 3> corners(const SceneObject& object, std::uint32_t triangle) const {
        const BakedMesh& mesh = meshes[object.mesh];
        const std::array<std::uint32_t, 3>& t = mesh.triangles[triangle];
        std::array<Vec3, 3> c{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
        if (object.instanced) c = {object.point(c[0]), object.point(c[1]), object.point(c[2])};
        return c;
    }
};

/// Moves the geometry out of the description. Meshes that are used once are transformed to world space; the others are
/// instanced. Degenerate triangles, and objects without triangles, are dropped. Panes get materials of their own, which
/// are appended to the description's.
BakedScene bake(SceneDescription& scene, const ThreadPool& pool);

/// Alpha of one triangle of a mesh, with the corners in the mesh's order.
TriangleAlpha alphaOf(const SceneDescription& scene, const BakedMesh& mesh, std::uint32_t triangle);

}  // namespace lacuna
