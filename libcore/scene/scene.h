// The scene for ray tracing: recentred (the origin is the centre of the bounding box), in float,
// const after construction.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libcore/scene/accel.h"
#include "libcore/scene/baked.h"
#include "libcore/scene/camera.h"
#include "libcore/scene/description.h"
#include "libcore/scene/environment.h"
#include "libcore/scene/light.h"
#include "libcore/scene/light_groups.h"
#include "libcore/scene/ray.h"
#include "libcore/scene/scene_names.h"
#include "libcore/scene/shading.h"
#include "libcore/scene/surfaces.h"

namespace lacuna {

class ThreadPool;

class Scene {
  public:
    /// Transforms meshes that are used once to world space, keeps the others as Embree instances, and builds lights,
    /// tables and hierarchies. Degenerate triangles are dropped. Throws InputError for an environment that cannot be
    /// read and for anything farther out than kFarthest, RunError if memory runs out.
    Scene(SceneDescription description, const ThreadPool& pool);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    /// The camera of that name, or the first one if the name is empty. Throws InputError if the
    /// scene has no camera or the camera is farther out than kFarthest, and UsageError, which lists
    /// the cameras, if none has that name.
    Camera makeCamera(const std::string& name, Camera::Film film, Camera::Lens lens) const;

    const SceneDescription& description() const { return description_; }
    const Lights& lights() const { return *lights_; }
    const Environment* environment() const { return environment_.get(); }
    /// Each call computes the following three anew.
    LightGroups lightGroups() const { return lacuna::lightGroups(namedLights()); }
    std::vector<NamedLights> namedLights() const;
    std::vector<ObjectNames> objectNames() const;
    const Accel& accel() const { return *accel_; }
    /// Centre of the file's bounding box: file coordinates = scene coordinates + centre().
    Vec3d centre() const { return baked_.centre; }
    /// Radius of the bounding sphere around the origin; 0 without geometry.
    float radius() const { return baked_.radius; }
    /// Half the sides of the bounding box, which is centred at the origin; zero without geometry.
    const Vec3& halfSize() const { return baked_.halfSize; }
    std::size_t triangleCount() const { return baked_.triangles; }
    /// The triangles that block light, in scene coordinates, once per instance, in a fixed order. Refracting glass is
    /// included, because it blocks connections. Left out are panes, and triangles whose alpha lets more than half of
    /// the light through (leaves, chains, veils).
    std::vector<std::array<Vec3, 3>> blockingTriangles(const ThreadPool& pool) const {
        return surfaces_.blocking(pool);
    }

    /// Whether a mesh of the scene has a material that `wanted` accepts.
    bool hasAny(bool (*wanted)(const Material&)) const { return surfaces_.any(wanted); }
    /// The triangles of those materials that `wanted` accepts, likewise.
    std::vector<std::array<Vec3, 3>> trianglesOf(bool (*wanted)(const Material&)) const {
        return surfaces_.of(wanted);
    }
    /// The triangles of one material, likewise.
    std::vector<std::array<Vec3, 3>> trianglesOf(std::size_t material) const {
        return surfaces_.of(material);
    }

    /// Closest surface along a ray from `origin`, which is moved off its surface along ng (ng zero:
    /// no surface).
    std::optional<Hit> trace(const Vec3& origin, const Vec3& ng, const Vec3& direction,
                             RayKind kind, RayTally& tally) const;
    /// The point of a hit; replaces all of `out`. Prefetches the texels that bsdfAt will read.
    void surfaceAt(const Hit& hit, SurfacePoint& out) const { surfaces_.pointAt(hit, out); }
    /// The shape of the surface at a hit, or of a clearcoat with its own normals. `point`: the point of the hit.
    SurfaceShape shapeAt(const Hit& hit, const SurfacePoint& point, bool clearcoat) const {
        return surfaces_.shapeAt(hit, point, clearcoat);
    }
    /// trace() followed by surfaceAt().
    std::optional<SurfacePoint> intersect(const Vec3& origin, const Vec3& ng, const Vec3& direction,
                                          RayKind kind, RayTally& tally) const;
    /// Whether two points are mutually visible. Each is moved off its surface towards the other.
    bool visible(const Vec3& a, const Vec3& ngA, const Vec3& b, const Vec3& ngB, RayKind kind,
                 RayTally& tally) const;
    /// Whether the ray from `a` along `direction` is free to infinity.
    bool visibleToInfinity(const Vec3& a, const Vec3& ngA, const Vec3& direction, RayKind kind,
                           RayTally& tally) const;

    /// Whether some textures of bsdfAt do not fit into the processor's nearer caches.
    bool hasFarTextures() const { return hasFarTextures_; }
    /// The share of rays along `direction` (of any length) that a surface stops: one, except where alpha or a pane lets
    /// some pass.
    float shareStopped(const Hit& hit, const Vec3& direction) const;
    /// Material of the object that was hit.
    const Material& materialAt(const Hit& hit) const;
    /// Evaluates the material's textures at the point.
    Bsdf bsdfAt(const SurfacePoint& point) const { return shading_.bsdfAt(point); }
    const AlbedoTables& albedoTables() const { return shading_.albedoTables(); }
    /// Absorption coefficients by material, per unit length; empty if no material absorbs.
    std::span<const Rgb> absorption() const { return absorption_; }

  private:
    /// Whether a ray stops at the hit: always, except where alpha or a pane lets some rays pass.
    /// Its origin and direction may be in the object's own space.
    bool stops(const Hit& hit, Vec3 origin, Vec3 direction) const;

    SceneDescription description_;
    BakedScene baked_;
    float offsetFloor_;
    bool hasFarTextures_ = false;
    Surfaces surfaces_;
    Shading shading_;
    std::vector<Rgb> absorption_;  // by material; empty if none absorbs
    std::unique_ptr<Environment> environment_;
    std::unique_ptr<Lights> lights_;
    std::unique_ptr<Accel> accel_;
};

}  // namespace lacuna
