// Surfaces at hits: the point with everything that a path vertex needs, and its opacity.
#pragma once

#include <array>
#include <vector>

#include "libcore/scene/baked.h"
#include "libcore/scene/ray.h"

namespace lacuna {

/// The point where a ray hit a surface.
struct SurfacePoint {
    Vec3 position;
    Vec3 ng;           ///< unit, by the winding (sign of the transform's determinant included)
    Vec3 ns;           ///< unit, on ng's side
    Vec3 clearcoatNs;  ///< unit, on ng's side, if the clearcoat has its own normals; else zero
    Vec3 grain;        ///< along a brushed surface, as long as the anisotropy's strength
    Vec2 uv, uv1;      ///< texture coordinates of both sets
    Rgb color{1.0f};   ///< vertex colour, a factor of the base colour
    Vec2 barycentric;
    std::uint32_t object = kNone;
    std::uint32_t material = 0;
    std::uint32_t light = kNone;  ///< area light of this triangle, if it emits
};

/// Position and curvature of a surface around a hit, in double, for ray differentials.
struct SurfaceShape {
    std::array<Vec3d, 3> corners;  ///< of the triangle, in the order of the hit's barycentrics
    Vec3d ng;                      ///< unit, like SurfacePoint::ng
    /// By corner, on ng's side. Their interpolation is along the shading normal.
    std::array<Vec3d, 3> normals;
};

/// The scene's triangles. Both references must outlive the object.
class Surfaces {
  public:
    Surfaces(const SceneDescription& description, const BakedScene& baked)
        : description_(description), baked_(baked) {}

    /// The point of a hit; replaces all of `out`. Prefetches the texels of its BSDF.
    void pointAt(const Hit& hit, SurfacePoint& out) const;

    /// The shape of the surface at a hit, or of a clearcoat with its own normals. `point`: the point of the hit. With a
    /// normal map, the normals are linearised around the hit by differences.
    SurfaceShape shapeAt(const Hit& hit, const SurfacePoint& point, bool clearcoat) const;

    /// The share of rays that the point stops by its alpha.
    float opacity(const Hit& hit) const;
    /// Whether the opacity may be below 1 somewhere on the object.
    bool hasHoles(const SceneObject& object) const;
    const Material& materialOf(const SceneObject& object) const {
        return description_.materials[baked_.meshes[object.mesh].material];
    }

    /// Scene::blockingTriangles.
    std::vector<std::array<Vec3, 3>> blocking(const ThreadPool& pool) const;
    /// Scene::hasAny.
    bool any(bool (*wanted)(const Material&)) const;
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
