// The scene as rays see it: recentred (the origin is the middle of the bounding box), in float,
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
    /// Bakes meshes that are used once into world space, keeps the others as Embree instances,
    /// builds lights, tables and hierarchies. Degenerate triangles are dropped. Throws InputError
    /// for an environment that cannot be read and for what is farther out than kFarthest, RunError if
    /// memory runs out.
    Scene(SceneDescription description, const ThreadPool& pool);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    /// Replaces nothing, decides nothing: the camera of that name, or the first. Throws InputError
    /// if the scene has no camera or has it farther out than kFarthest, UsageError if none has that
    /// name (both list what there is).
    Camera makeCamera(const std::string& name, Camera::Film film, Camera::Lens lens) const;

    const SceneDescription& description() const { return description_; }
    const Lights& lights() const { return *lights_; }
    const Environment* environment() const { return environment_.get(); }
    /// These three are made anew at each call.
    LightGroups lightGroups() const { return lacuna::lightGroups(namedLights()); }
    std::vector<NamedLights> namedLights() const;
    std::vector<ObjectNames> objectNames() const;
    const Accel& accel() const { return *accel_; }
    /// Middle of the file's bounding box: file coordinates = ours + centre().
    Vec3d centre() const { return baked_.centre; }
    /// Radius of the bounding sphere about the origin; 0 without geometry.
    float radius() const { return baked_.radius; }
    /// Half the sides of the bounding box, whose middle is the origin; zero without geometry.
    const Vec3& halfSize() const { return baked_.halfSize; }
    std::size_t triangleCount() const { return baked_.triangles; }
    /// The triangles that stop light, in our coordinates, instances each time, in a fixed order.
    /// That is all of them, glass that bends light too: a connection does not pass it either. Left out
    /// are panes, and triangles of which alpha lets more than half through (leaves, chains, veils).
    std::vector<std::array<Vec3, 3>> blockingTriangles(const ThreadPool& pool) const {
        return surfaces_.blocking(pool);
    }

    /// The triangles of materials that are `wanted`, likewise.
    std::vector<std::array<Vec3, 3>> trianglesOf(bool (*wanted)(const Material&)) const {
        return surfaces_.of(wanted);
    }
    /// Likewise of one material.
    std::vector<std::array<Vec3, 3>> trianglesOf(std::size_t material) const {
        return surfaces_.of(material);
    }

    /// Closest surface along a ray that leaves `origin` (offset off its surface; ng zero: no
    /// surface).
    std::optional<Hit> trace(const Vec3& origin, const Vec3& ng, const Vec3& direction,
                             RayKind kind, RayTally& tally) const;
    /// The point of a hit; all of `out` is replaced. Asks the cache for the texels that bsdfAt will
    /// look at.
    void surfaceAt(const Hit& hit, SurfacePoint& out) const { surfaces_.pointAt(hit, out); }
    /// The shape at a hit, whose point is `point`: of the surface, or of a clearcoat with normals of its own.
    SurfaceShape shapeAt(const Hit& hit, const SurfacePoint& point, bool clearcoat) const {
        return surfaces_.shapeAt(hit, point, clearcoat);
    }
    /// Closest surface and its point, one after the other.
    std::optional<SurfacePoint> intersect(const Vec3& origin, const Vec3& ng, const Vec3& direction,
                                          RayKind kind, RayTally& tally) const;
    /// Whether two points see each other; each is moved off its surface towards the other.
    bool visible(const Vec3& a, const Vec3& ngA, const Vec3& b, const Vec3& ngB, RayKind kind,
                 RayTally& tally) const;
    /// Whether `a` sees infinitely far along `direction`.
    bool visibleToInfinity(const Vec3& a, const Vec3& ngA, const Vec3& direction, RayKind kind,
                           RayTally& tally) const;

    /// Whether some textures of bsdfAt are larger than the processor's nearer caches.
    bool hasFarTextures() const { return hasFarTextures_; }
    /// The share of rays along `direction`, of any length, that a surface stops: one, but where alpha
    /// or a pane lets some of them pass.
    float shareStopped(const Hit& hit, const Vec3& direction) const;
    /// Of the object that was hit.
    const Material& materialAt(const Hit& hit) const;
    /// Evaluates the material's textures at the point.
    Bsdf bsdfAt(const SurfacePoint& point) const { return shading_.bsdfAt(point); }
    const AlbedoTables& albedoTables() const { return shading_.albedoTables(); }
    /// Of the materials' bodies, per unit of length; empty where none absorbs.
    std::span<const Rgb> absorption() const { return absorption_; }

  private:
    /// Whether a ray (of which origin and direction may be in the object's own space) stops at the
    /// hit: always, but where alpha or a pane lets some of them pass.
    bool stops(const Hit& hit, Vec3 origin, Vec3 direction) const;

    SceneDescription description_;
    BakedScene baked_;
    float offsetFloor_;
    bool hasFarTextures_ = false;
    Surfaces surfaces_;
    Shading shading_;
    std::vector<Rgb> absorption_;  // by material; empty where none absorbs
    std::unique_ptr<Environment> environment_;
    std::unique_ptr<Lights> lights_;
    std::unique_ptr<Accel> accel_;
};

}  // namespace lacuna
