// Rays, hits and their counters: plain structs that hide Embree from everything but accel.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

/// The purpose of a ray. Rays are counted by kind.
enum class RayKind : std::uint8_t {
    Camera,
    EyeWalk,
    LightWalk,
    Connection,
    Splat,
    Cache,
    Chain,  ///< search for specular chains (mirrors and smooth glass), and tests along them
    Count
};
inline constexpr std::size_t kRayKinds = std::size_t(RayKind::Count);
const char* name(RayKind kind);

struct Ray {
    Vec3 origin;
    Vec3 direction;  ///< any length: tFar is in its units
    float tFar = std::numeric_limits<float>::infinity();
    bool atLens = false;  ///< one end is the lens: it passes objects hidden from the camera
};

inline constexpr std::uint32_t kNone = 0xffffffffu;

struct Hit {
    std::uint32_t object = kNone;     ///< index of the object in the scene
    std::uint32_t primitive = kNone;  ///< index of the triangle in the object's mesh
    float u = 0, v = 0;  ///< barycentric weights of the triangle's second and third corner
    float distance = 0;  ///< along the ray, in lengths of its direction
};

using RayCounts = std::array<std::uint64_t, kRayKinds>;

/// One traced ray, for the benchmark that replays them through bare Embree.
struct RecordedRay {
    Ray ray;  ///< tFar: for closest hits the distance found (infinity: a miss)
    RayKind kind;
};

/// State of ray tracing per worker: counters, and a recording if a benchmark wants one.
struct RayTally {
    RayCounts counts{};
    std::vector<RecordedRay>* recording = nullptr;
};

}  // namespace lacuna
