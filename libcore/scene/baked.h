// The scene's meshes and objects as rays see them: in float, about the middle of the bounding box.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/scene/alpha.h"
#include "libcore/scene/description.h"

namespace lacuna {

class ThreadPool;

/// World space for a mesh that is used once, else the mesh's own space moved to its middle (so that
/// large offsets in the file cost no precision).
struct BakedMesh {
    std::vector<Vec3> positions;  // one more than there are vertices (accel.h)
    std::vector<Vec3> normals;
    std::vector<std::array<float, 4>> tangents;  // as in the file, but in this mesh's space
    std::vector<Vec2> uvs, uvs1;
    std::vector<std::array<float, 4>> colors;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec3> faceNormals;  // world-space meshes only: looked up at every hit
    std::uint32_t material = 0;
    bool plain = true;  ///< neither vertex colours, nor a second set, nor what turns its BSDF
    /// Those of the BSDF that the processor's nearer caches do not hold.
    std::vector<TextureUse> farTextures;

    /// The coordinates by which a texture lies on the mesh; may be empty.
    const std::vector<Vec2>& uvsOf(const TextureUse& use) const {
        return use.secondSet ? uvs1 : uvs;
    }
    /// Of those coordinates the triangle's; zeros where there are none.
    std::array<Vec2, 3> uvsOf(const TextureUse& use, std::uint32_t triangle) const;
    Vec3 tangentAt(const std::array<std::uint32_t, 3>& t, float u, float v) const;
    /// Whether some vertex colours are translucent.
    bool hasVertexAlpha() const;
};

/// A mesh where it stands.
struct SceneObject {
    std::uint32_t mesh = 0;
    bool instanced = false;  ///< else the mesh is in world space
    bool mirrored = false;
    std::array<Vec3, 4> toWorld;                    // columns and translation
    std::array<Vec3, 3> normal;                     // of the transform of normals
    std::uint32_t firstLight = kNoLight;            ///< that of its first triangle, where it emits
    std::uint32_t lightGroup = Instance::kNoGroup;  ///< that of its instance
    std::uint32_t nodeName = Instance::kNoName;     ///< likewise

    static constexpr std::uint32_t kNoLight = 0xffffffffu;

    Vec3 point(Vec3 p) const {
        return toWorld[0] * p.x + toWorld[1] * p.y + toWorld[2] * p.z + toWorld[3];
    }
    Vec3 vector(Vec3 v) const { return toWorld[0] * v.x + toWorld[1] * v.y + toWorld[2] * v.z; }
    Vec3 normalTo(Vec3 n) const { return normal[0] * n.x + normal[1] * n.y + normal[2] * n.z; }
    /// Whether the front, the image of the mesh's front, is not the side of the corners' order.
    bool turned() const { return instanced && mirrored; }
};

struct BakedScene {
    Vec3d centre;         ///< middle of the file's bounding box: file coordinates = ours + centre
    float radius = 0.0f;  ///< of the bounding sphere about the origin; 0 without geometry
    Vec3 halfSize;        ///< of the bounding box, half of each side; likewise
    std::size_t triangles = 0;  ///< instances each time
    std::vector<BakedMesh> meshes;
    std::vector<SceneObject> objects;

    /// World-space corners, in the mesh's order.
    std::array<Vec3, 3> corners(const SceneObject& object, std::uint32_t triangle) const;
};

/// Takes the geometry out of the description: meshes that are used once are baked into world space,
/// the others stay to be instanced. Degenerate triangles and objects without any are dropped. Panes get
/// materials of their own, behind the others.
BakedScene bake(SceneDescription& scene, const ThreadPool& pool);

/// Alpha of one of the object's triangles, whose corners come in the mesh's order.
TriangleAlpha alphaOf(const SceneDescription& scene, const BakedMesh& mesh, std::uint32_t triangle);

}  // namespace lacuna
