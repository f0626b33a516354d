// What a ray meets: the point of a hit with everything a path vertex needs, and whether it is
// there.
#pragma once

#include <array>
#include <vector>

#include "libcore/scene/baked.h"
#include "libcore/scene/ray.h"

namespace lacuna {

/// Where a ray met a surface.
struct SurfacePoint {
    Vec3 position;
    Vec3 ng;           ///< unit, by the winding (sign of the transform's determinant included)
    Vec3 ns;           ///< unit, on ng's side
    Vec3 clearcoatNs;  ///< unit, on ng's side, where the clearcoat's normals are its own; else zero
    Vec3 grain;        ///< along a brushed surface; its length is the anisotropy's strength
    Vec2 uv, uv1;      ///< texture coordinates of either set
    Rgb color{1.0f};   ///< the vertices', a factor on the base colour
    Vec2 barycentric;
    std::uint32_t object = kNone;
    std::uint32_t material = 0;
    std::uint32_t light = kNone;  ///< area light of this triangle, if it emits
};

/// How a surface lies and bends around a hit, in double: what differentials of rays are made of.
struct SurfaceShape {
    std::array<Vec3d, 3> corners;  ///< of the triangle, in the order of the hit's coordinates
    Vec3d ng;                      ///< unit, as SurfacePoint's
    /// By corner: the shading normal, on ng's side, is along what lies between them.
    std::array<Vec3d, 3> normals;
};

/// The scene's triangles. Both references must outlive it.
class Surfaces {
  public:
    Surfaces(const SceneDescription& description, const BakedScene& baked)
        : description_(description), baked_(baked) {}

    /// The point of a hit; all of `out` is replaced. Asks the cache for the texels of its BSDF.
    void pointAt(const Hit& hit, SurfacePoint& out) const;

    /// The shape at a hit, whose point is `point`: of the surface, or of a clearcoat that has normals of its own. Where a
    /// normal map bends it, that is its tangent plane, by differences of texels.
    SurfaceShape shapeAt(const Hit& hit, const SurfacePoint& point, bool clearcoat) const;

    /// Alpha's: the share of the rays that find the point there.
    float opacity(const Hit& hit) const;
    /// Whether that may be below 1 somewhere on the object.
    bool hasHoles(const SceneObject& object) const;
    const Material& materialOf(const SceneObject& object) const {
        return description_.materials[baked_.meshes[object.mesh].material];
    }

    /// Scene::blockingTriangles.
    std::vector<std::array<Vec3, 3>> blocking(const ThreadPool& pool) const;
    /// Scene::trianglesOf.
    std::vector<std::array<Vec3, 3>> of(bool (*wanted)(const Material&)) const;
    std::vector<std::array<Vec3, 3>> of(std::size_t material) const;

  private:
    struct MapAxes;

    void decorate(const Hit& hit, const std::array<Vec3, 3>& corners, bool turned,
                  SurfacePoint& out) const;
    MapAxes axesOf(const Hit& hit, const std::array<Vec3, 3>& corners, const TextureUse& map,
                   bool turned, const Vec3& ns) const;
    Vec3 bumped(const SurfacePoint& point, const TextureUse& map, float scale,
                const MapAxes& axes) const;
    Vec3 grainAt(const SurfacePoint& point, const Material& material, const MapAxes& axes) const;
    bool mostlyHoles(const TriangleAlpha& alpha) const;
    template <class Wanted>
    std::vector<std::array<Vec3, 3>> ofObjects(const Wanted& wanted) const;

    const SceneDescription& description_;
    const BakedScene& baked_;
};

}  // namespace lacuna
