// Where the random numbers of a render's streams come from. (theory.md, "Even numbers")
#pragma once

#include <cstdint>

#include "libcore/base/rng.h"

namespace lacuna {

enum class Sampling {
    Sobol,        ///< even over the iterations
    Independent,  ///< all of them independent
};
/// The name that --sampler has for it.
constexpr const char* nameOf(Sampling sampling) {
    return sampling == Sampling::Sobol ? "sobol" : "independent";
}

/// Dimensions of streams. A vertex has its own, whatever the vertices before it drew.
namespace dimension {
/// Dimensions before the first vertex of a walk: pixel and lens, or lamp and direction.
inline constexpr std::uint32_t kStart = 3;
/// Dimensions of a walk's vertex: roulette, lobe, direction. Those of a vertex that picks: lamp,
/// its point, pick.
inline constexpr std::uint32_t kPerVertex = 3;
/// How many vertices have dimensions.
inline constexpr std::uint32_t kVertices = 6;

/// The first dimension of vertex `index` >= 1 of its subpath.
constexpr std::uint32_t ofWalk(std::uint32_t index) {
    return kStart + (index - 1) * kPerVertex;
}
/// The first dimension of the picks at z_{t-1}, t >= 2.
constexpr std::uint32_t ofPicks(std::uint32_t t) {
    return (t - 2) * kPerVertex;
}
}  // namespace dimension

class Sampler {
  public:
    Sampler(Sampling sampling, std::uint64_t seed);

    /// Number of iterations in a group, a power of two. Variances come from the spread of groups
    /// (theory.md, "Even numbers").
    static std::uint64_t groupOf(Sampling sampling);

    /// The stream of an iteration for this kind and index. Where the kind has dimensions, the numbers of all iterations
    /// lie evenly together.
    Rng stream(std::uint32_t iteration, StreamKind kind, std::uint64_t index) const;

  private:
    Sampling sampling_;
    std::uint64_t seed_, sequences_;  // sequences_: scrambling, from the seed
};

}  // namespace lacuna
