// Ways on which light comes over mirrors and through smooth glass, traced once from the lights: what a search
// for chains at a place nearby begins with [Fan23]. (theory.md, "Specular chains", "Next event along known
// ways")
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
    /// Root of the second moment that walks have which run into the lamp this way, over the power of all lights;
    /// zero where lights have no size.
    float deviation = 0;
};

/// Ways that ended near a place, and one of each kind that came more than once: what comes the same way.
struct WaysNearby {
    static constexpr std::size_t kMostKinds = 4;
    std::span<const ChainSeed> all;
    std::span<const std::uint8_t> kinds;  ///< where they stand in `all`, the most frequent first
    /// Their deviations together, per square metre; zero where the place lies beside them.
    double deviationPerArea = 0;
};

class ChainSeeds {
  public:
    /// Of all lights, the more of one the more power it has. A function of the scene.
    ChainSeeds(const Scene& scene, const ThreadPool& threads);

    /// Some of a light's, which has no extent, that ended near a place on a surface that looks to `side`,
    /// if any did anywhere.
    WaysNearby near(std::uint32_t light, const Vec3& place, const Vec3& side) const;
    /// Likewise of all lights that walks run into, where walks seldom do.
    WaysNearby nearOfLamps(const Vec3& place, const Vec3& side) const;
    bool anyOfLamps() const { return !ofLamps_.seeds.empty(); }

  private:
    /// Where a way ended, and the way.
    struct Arrival {
        Vec3 side;  // of the surface
        ChainSeed seed;
    };
    std::uint32_t codeOf(const Vec3& place, const Vec3& side) const;
    struct Ray {
        Vec3 origin;
        Vec3d direction;
        double power;  // share of all that the lights have
    };
    static void followRay(const ChainSolver& solver, const LightPoint& from, const Ray& ray,
                          Rng& rng, std::vector<Arrival>& arrivals);

    /// What is known of as many ways as a place has.
    struct Window {
        std::array<std::uint8_t, WaysNearby::kMostKinds> kinds;  // WaysNearby::kinds
        std::uint8_t size = 0;
        // The ball that they ended in, and their deviations together over its disk.
        Vec3 centre;
        float radius = 0;
        double deviationPerArea = 0;
    };
    static Window windowOf(std::span<const ChainSeed> ways);

    struct Sorted {
        std::vector<std::uint32_t> codes;  // ascending
        std::vector<ChainSeed> seeds;      // in that order
        std::vector<Window> windows;       // by the first of their ways
    };
    Sorted sorted(std::span<const std::vector<Arrival>> arrivals, const ThreadPool& threads) const;
    WaysNearby near(const Sorted& ways, const Vec3& place, const Vec3& side) const;

    std::vector<Sorted> byLight_;  // of all lights; empty: none is without an extent
    Sorted ofLamps_;
    float half_ = 1.0f;  // of the cube that places lie in
};

}  // namespace lacuna
