// Where the random numbers of a render's streams come from. (theory.md, "Even numbers")
#pragma once

#include <cstdint>

#include "libcore/base/rng.h"

namespace lacuna {

enum class Sampling {
    Sobol,        ///< even over the iterations
    Independent,  ///< all of them independent
};
/// As --sampler names it.
constexpr const char* nameOf(Sampling sampling) {
    return sampling == Sampling::Sobol ? "sobol" : "independent";
}

/// Dimensions of streams. A vertex has its own, whatever the vertices before it drew.
namespace dimension {
/// Before the first vertex of a walk: pixel and lens, or lamp and direction.
inline constexpr std::uint32_t kStart = 3;
/// Of a vertex of a walk: roulette, lobe, direction. Of one that picks: lamp, its point, pick.
inline constexpr std::uint32_t kPerVertex = 3;
/// How many vertices have any.
inline constexpr std::uint32_t kVertices = 6;

/// The first one of vertex `index` >= 1 of its subpath.
constexpr std::uint32_t ofWalk(std::uint32_t index) {
    return kStart + (index - 1) * kPerVertex;
}
/// Of what z_{t-1} picks, t >= 2.
constexpr std::uint32_t ofPicks(std::uint32_t t) {
    return (t - 2) * kPerVertex;
}
}  // namespace dimension

class Sampler {
  public:
    Sampler(Sampling sampling, std::uint64_t seed);

    /// Iterations of a group, a power of two: what they spread by is what variances are told by
    /// (theory.md, "Even numbers").
    static std::uint64_t groupOf(Sampling sampling);

    /// A stream of an iteration; where its kind has dimensions, even with those of its kind and index of
    /// all others.
    Rng stream(std::uint32_t iteration, StreamKind kind, std::uint64_t index) const;

  private:
    Sampling sampling_;
    std::uint64_t seed_, sequences_;  // sequences_: which ones, by seed
};

}  // namespace lacuna
