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

/// An object of the scene: a mesh in world space, or an instance of a shared mesh.
struct AccelObject {
    std::uint32_t mesh = 0;
    bool instanced = false;
    Affine toWorld;                 ///< used if instanced
    bool hasHoles = false;          ///< rays can pass through some of its points
    bool hiddenFromCamera = false;  ///< rays with an end at the lens pass it
};

/// Triangles in Embree's layout. `positions` must have one element more than there are vertices:
/// Embree loads 16 bytes at a time.
struct AccelMesh {
    std::span<const Vec3> positions;
    std::span<const std::array<std::uint32_t, 3>> triangles;
};

class Accel {
  public:
    /// Tells whether an object with holes stops this ray at this point. The ray's origin and
    /// direction may be in the object's own space.
    using HoleTest = std::function<bool(const Hit&, Vec3 origin, Vec3 direction)>;

    /// Builds the hierarchies in `pool`'s threads. The spans must outlive the object. Throws
    /// RunError if Embree cannot build them, std::bad_alloc if memory runs out.
    Accel(std::span<const AccelMesh> meshes, std::span<const AccelObject> objects,
          HoleTest holeTest, const ThreadPool& pool);
    ~Accel();
    Accel(Accel&&) noexcept;
    Accel& operator=(Accel&&) noexcept;

    /// Closest surface along the ray.
    std::optional<Hit> intersect(const Ray& ray) const;
    /// Whether anything lies on the ray before its tFar.
    bool occluded(const Ray& ray) const;

    /// Traces recorded rays again, one by one in their order, with Embree alone. Benchmarks compare
    /// a renderer's rate with this. Returns the number of rays that hit something.
    std::size_t replay(std::span<const RecordedRay> rays) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// `origin` moved off its surface along `ng`, to the side of `direction`, by 2^-16 of its largest
/// coordinate (128 to 256 float steps there) or of `floor` if that is larger. It follows [Waechter
/// and Binder 2019] but has no absolute constants: `floor`, a fixed share of the scene's radius,
/// covers the error of points near the origin on large triangles.
inline Vec3 offsetOrigin(Vec3 origin, Vec3 ng, Vec3 direction, float floor) {
    const float magnitude = std::max(
        floor, std::max(std::fabs(origin.x), std::max(std::fabs(origin.y), std::fabs(origin.z))));
    const float step = std::copysign(0x1p-16f, dot(direction, ng));
    return origin + ng * (step * magnitude);
}

}  // namespace lacuna
