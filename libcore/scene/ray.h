// Rays, hits and their bookkeeping: plain structs that everything but accel.cpp sees instead of
// Embree.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

/// What a ray is traced for; rays are counted by kind.
enum class RayKind : std::uint8_t {
    Camera,
    EyeWalk,
    LightWalk,
    Connection,
    Splat,
    Cache,
    Chain,  ///< in search of chains of mirrors and smooth glass, and along them
    Count
};
inline constexpr std::size_t kRayKinds = std::size_t(RayKind::Count);
const char* name(RayKind kind);

struct Ray {
    Vec3 origin;
    Vec3 direction;  ///< any length: tFar is in its units
    float tFar = std::numeric_limits<float>::infinity();
    bool atLens = false;  ///< one of its ends is the lens: it passes what the camera does not see
};

inline constexpr std::uint32_t kNone = 0xffffffffu;

struct Hit {
    std::uint32_t object = kNone;     ///< index of the scene's object
    std::uint32_t primitive = kNone;  ///< triangle of the object's mesh
    float u = 0, v = 0;  ///< barycentric weights of the triangle's second and third corner
    float distance = 0;  ///< along the ray, in lengths of its direction
};

using RayCounts = std::array<std::uint64_t, kRayKinds>;

/// One traced ray, for the benchmark that replays them through bare Embree.
struct RecordedRay {
    Ray ray;  ///< tFar: for closest hits the distance that was found (infinity: a miss)
    RayKind kind;
};

/// Per-worker state of ray tracing: counters, and a recording where a benchmark asks for one.
struct RayTally {
    RayCounts counts{};
    std::vector<RecordedRay>* recording = nullptr;
};

}  // namespace lacuna
