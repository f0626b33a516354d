// The scene as rays see it: recentred (the origin is the middle of the bounding box), in float,
// const after construction.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf.h"
#include "libcore/scene/accel.h"
#include "libcore/scene/camera.h"
#include "libcore/scene/description.h"
#include "libcore/scene/environment.h"
#include "libcore/scene/light.h"
#include "libcore/scene/ray.h"
#include "libcore/scene/texture.h"

namespace lacuna {

class ThreadPool;

/// Where a ray met a surface, with everything a path vertex needs.
struct SurfacePoint {
    Vec3 position;
    Vec3 ng;          ///< unit, by the winding (sign of the transform's determinant included)
    Vec3 ns;          ///< unit, on ng's side
    Vec2 uv, uv1;     ///< texture coordinates of either set
    Rgb color{1.0f};  ///< the vertices', a factor on the base colour
    Vec2 barycentric;
    std::uint32_t material = 0;
    std::uint32_t light = kNone;  ///< area light of this triangle, if it emits
};

class Scene {
  public:
    /// Bakes meshes that are used once into world space, keeps the others as Embree instances,
    /// builds lights, tables and hierarchies. Degenerate triangles are dropped. Throws InputError
    /// for an environment that cannot be read, RunError if memory runs out.
    Scene(SceneDescription description, const ThreadPool& pool);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    /// Replaces nothing, decides nothing: the camera of that name, or the first. Throws InputError
    /// if the scene has no camera, UsageError if none has that name (both list what there is).
    Camera makeCamera(const std::string& name, Camera::Film film, Camera::Lens lens) const;

    const SceneDescription& description() const { return description_; }
    const Lights& lights() const { return *lights_; }
    const Environment* environment() const { return environment_.get(); }
    const Accel& accel() const { return *accel_; }
    /// Middle of the file's bounding box: file coordinates = ours + centre().
    Vec3d centre() const { return centre_; }
    /// Radius of the bounding sphere about the origin; 0 without geometry.
    float radius() const { return radius_; }
    std::size_t triangleCount() const { return triangleCount_; }
    /// The triangles that stop light, in our coordinates, instances each time, in a fixed order.
    /// That is all of them, glass too: a connection does not pass through glass either. Left out
    /// are triangles of which alpha lets more than half through (leaves, chains, veils).
    std::vector<std::array<Vec3, 3>> blockingTriangles(const ThreadPool& pool) const;

    /// Closest surface along a ray that leaves `origin` (offset off its surface; ng zero: no
    /// surface).
    std::optional<Hit> trace(const Vec3& origin, const Vec3& ng, const Vec3& direction,
                             RayKind kind, RayTally& tally) const;
    /// The point of a hit; all of `out` is replaced. Asks the cache for the texels that bsdfAt will
    /// look at.
    void surfaceAt(const Hit& hit, SurfacePoint& out) const;
    /// Both, one after the other.
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
    /// Evaluates the material's textures at the point.
    Bsdf bsdfAt(const SurfacePoint& point) const;
    const AlbedoTables& albedoTables() const { return *tables_; }
    /// Of the materials' bodies, per unit of length; empty where none absorbs.
    std::span<const Rgb> absorption() const { return absorption_; }
    /// Material of an area light.
    std::uint32_t materialOf(std::uint32_t light) const;

  private:
    struct Object;
    struct WorldMesh;
    struct MapAxes;
    /// What a material has in common wherever it is.
    struct PreparedBsdf {
        std::optional<Bsdf> bsdf;  ///< where nothing but the base colour varies; white then
        bool colorVaries = false;
    };

    void decorate(const Hit& hit, const std::array<Vec3, 3>& corners, bool turned,
                  SurfacePoint& out) const;
    Vec3 bumped(const SurfacePoint& point, const TextureUse& map, float scale,
                const MapAxes& axes) const;
    /// Whether rays can pass through some of the mesh's points.
    bool hasHoles(const Material& material, const WorldMesh& mesh) const;
    float opacity(const Hit& hit) const;
    bool isThere(const Hit& hit, Vec3 origin, Vec3 direction) const;
    Rgba sample(const TextureUse& use, Vec2 uv, Vec2 uv1) const {
        return sampleTexture(description_.textures[std::size_t(use.value)],
                             use.at(use.secondSet ? uv1 : uv));
    }
    Rgb baseColorAt(const Material& material, Vec2 uv, Vec2 uv1) const;
    PreparedBsdf prepared(const Material& material, bool vertexColors) const;
    Bsdf::Parameters bsdfParameters(const Material& material, Vec2 uv, Vec2 uv1) const;
    bool mostlyHoles(std::uint32_t object, std::uint32_t primitive) const;
    static Vec2 uvAt(const std::vector<Vec2>& uvs, const std::array<std::uint32_t, 3>& triangle,
                     float u, float v);

    SceneDescription description_;
    Vec3d centre_;
    float radius_ = 0.0f;
    float offsetFloor_ = 0.0f;
    std::size_t triangleCount_ = 0;
    bool hasFarTextures_ = false;
    std::vector<WorldMesh> meshes_;
    std::vector<Object> objects_;
    std::unique_ptr<AlbedoTables> tables_;
    std::vector<PreparedBsdf> preparedBsdfs_;  // by material
    std::vector<Rgb> absorption_;              // by material; empty where none absorbs
    std::unique_ptr<Environment> environment_;
    std::unique_ptr<Lights> lights_;
    std::unique_ptr<Accel> accel_;
};

}  // namespace lacuna
