// Ray queries. accel.cpp is the only file that includes Embree.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/scene/ray.h"

namespace lacuna {

class ThreadPool;

/// One thing in the scene: a mesh that is already in world space, or an instance of a shared one.
struct AccelObject {
    std::uint32_t mesh = 0;
    bool instanced = false;
    Affine toWorld;                 ///< used where instanced
    bool hasHoles = false;          ///< some of its points may not be there
    bool hiddenFromCamera = false;  ///< rays at the lens pass it
};

/// Triangles as Embree reads them. `positions` must have one more element than vertices: Embree
/// loads 16 bytes at a time.
struct AccelMesh {
    std::span<const Vec3> positions;
    std::span<const std::array<std::uint32_t, 3>> triangles;
};

class Accel {
  public:
    /// Tells whether the surface of an object with holes is there at this point, for a ray (of
    /// which origin and direction may be in the object's own space).
    using HoleTest = std::function<bool(const Hit&, Vec3 origin, Vec3 direction)>;

    /// Builds the hierarchies (in `pool`'s threads). The spans must outlive the object. Throws
    /// RunError if Embree cannot build (out of memory).
    Accel(std::span<const AccelMesh> meshes, std::span<const AccelObject> objects,
          HoleTest holeTest, const ThreadPool& pool);
    ~Accel();
    Accel(Accel&&) noexcept;
    Accel& operator=(Accel&&) noexcept;

    /// Closest surface along the ray.
    std::optional<Hit> intersect(const Ray& ray) const;
    /// Whether anything lies on the ray before its tFar.
    bool occluded(const Ray& ray) const;

    /// The rays again, one by one in their order, through nothing but Embree: what the benchmarks
    /// compare a renderer's rate with. Returns how many hit something.
    std::size_t replay(std::span<const RecordedRay> rays) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// `origin` moved off its surface along `ng`, towards the side that `direction` leads to, by 2^-16
/// of its largest coordinate (128 to 256 of the float steps there) or of `floor` where that is
/// larger. Follows [Waechter and Binder 2019], but free of absolute constants: `floor`, a fixed
/// share of the scene's radius, stands for the error of points that lie near the origin on large
/// triangles.
inline Vec3 offsetOrigin(Vec3 origin, Vec3 ng, Vec3 direction, float floor) {
    const float magnitude = std::max(
        floor, std::max(std::fabs(origin.x), std::max(std::fabs(origin.y), std::fabs(origin.z))));
    const float step = std::copysign(0x1p-16f, dot(direction, ng));
    return origin + ng * (step * magnitude);
}

}  // namespace lacuna
