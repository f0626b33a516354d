// Ways on which light without an extent comes over mirrors and through smooth glass, traced once from the
// lights: what a search for chains at a place nearby begins with [Fan23]. (theory.md, "Specular chains")
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/parallel.h"
#include "libcore/specular/chain_solver.h"

namespace lacuna {

/// A way that was seen to end on a surface that scatters.
struct ChainSeed {
    Vec3 end;                                          ///< there
    Vec3 towards;                                      ///< its first vertex, from the eye's side
    std::array<SpecularEvent, Chain::kMost> events{};  ///< from the eye's side
    std::uint8_t size = 0;
};

/// Ways that ended near a place, and one of each kind that came more than once: what comes the same way.
struct WaysNearby {
    static constexpr std::size_t kMostKinds = 4;
    std::span<const ChainSeed> all;
    std::span<const std::uint8_t> kinds;  ///< where they stand in `all`, the most frequent first
};

class ChainSeeds {
  public:
    /// Of all lights without an extent, the more of one the more power it has. A function of the scene.
    ChainSeeds(const Scene& scene, const ThreadPool& threads);

    /// Some of a light's that ended near a place on a surface that looks to `side`, if any did anywhere.
    WaysNearby near(std::uint32_t light, const Vec3& place, const Vec3& side) const;

  private:
    std::uint32_t codeOf(const Vec3& place, const Vec3& side) const;

    struct Kinds {
        std::array<std::uint8_t, WaysNearby::kMostKinds> places;
        std::uint8_t size = 0;
    };
    static Kinds kindsOf(std::span<const ChainSeed> ways);

    struct OfLight {
        std::vector<std::uint32_t> codes;  // ascending
        std::vector<ChainSeed> seeds;      // in that order
        std::vector<Kinds> kinds;          // of the ways that a place has, by the first of them
    };
    std::vector<OfLight> byLight_;  // of all lights; empty: there are none
    float half_ = 1.0f;             // of the cube that places lie in
};

}  // namespace lacuna
