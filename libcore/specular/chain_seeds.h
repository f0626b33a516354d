// Ways on which light comes over mirrors and through smooth glass, traced once from the lights: what a search
// for chains at a place nearby begins with [Fan23]. (theory.md, "Specular chains", "Next event along known
// ways")
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/parallel.h"
#include "libcore/specular/chain_solver.h"

namespace lacuna {

/// A way that was seen to end on a surface that scatters.
struct ChainSeed {
    Vec3 end;            ///< there
    Vec3 direction;      ///< unit, from there to its first vertex
    float distance = 0;  ///< of that vertex, in metres
    /// Change of the direction with the end, per metre, both by two axes across it.
    std::array<std::array<float, 2>, 2> turn{};
    std::array<SpecularEvent, Chain::kMost> events{};  ///< from the eye's side
    std::uint8_t size = 0;
    /// Of a light without a size, the power that comes this way, over what its whole power brings to a square metre of the
    /// sphere around the scene. Of lamps and skies, the root of the second moment that walks have which run into them
    /// this way, over what all lights bring there.
    float strength = 0;

    bool hasEventsOf(const Chain& chain) const;
    /// Unit, of a way over the same surfaces from the same light that ends at a place nearby: exact as its
    /// distance goes to zero.
    Vec3d directionAt(const Vec3d& place) const;
};

/// Ways that ended near a place. What comes over the same events from about the same direction is of one kind.
struct WaysNearby {
    static constexpr std::size_t kMostUsual = 8, kMostOthers = 28;
    std::span<const ChainSeed> all;  ///< of the light, or of all lamps
    // Where they stand in `all`:
    /// One of each kind that came here; of lamps, more than once.
    std::span<const std::uint32_t> usual;
    std::span<const std::uint32_t> others;  ///< all that came here, then kinds from farther around
    /// Of all that came here, per square metre; zero where the place lies beside it.
    double strength = 0;

    /// An expected number of samples by that: samples which cost the same are worth most where their number goes as
    /// the root of the second moment of what they bring.
    double samples(double fewest) const {
        constexpr double kByStrength = 0.25;
        return strength > 0.0 ? std::clamp(kByStrength * strength, fewest, 1.0) : fewest;
    }
};

class ChainSeeds {
  public:
    /// Of all lights, the more of one the more power it has. A function of the scene.
    ChainSeeds(const Scene& scene, const ThreadPool& threads);

    /// What a way that ended near a place says of the lights.
    struct LightShare {
        std::uint32_t light;
        float power;  ///< the share of all light that the way stands for
    };
    /// Of all lights without an extent, if there are several: ways that ended near a place on a surface that looks to
    /// `side`.
    std::span<const LightShare> lightsNear(const Vec3& place, const Vec3& side) const;
    /// A light's, which has no extent, that ended near a place on a surface that looks to `side`, if any did
    /// anywhere.
    WaysNearby near(std::uint32_t light, const Vec3& place, const Vec3& side) const;
    /// Likewise of all lights that walks run into, where walks seldom do.
    WaysNearby nearOfLamps(const Vec3& place, const Vec3& side) const;
    bool anyOfLamps() const { return !ofLamps_.seeds.empty(); }
    /// Whether the scene has lights without an extent, and anything that their chains could go over.
    bool hasPoints() const { return !byLight_.empty(); }

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

    /// A kind of ways: what stands for it, and how many there are.
    struct Kind {
        std::uint32_t way;
        Vec3 direction;  // of the first one
        int count;
    };
    static bool isOf(const Kind& kind, std::span<const ChainSeed> all, const ChainSeed& way);
    static std::vector<Kind> kindsOf(std::span<const ChainSeed> all, std::size_t first,
                                     std::size_t size);

    /// Which kinds of ways are usual: those that came so often, and how many.
    struct UsualKinds {
        int fewestWays;
        std::size_t most;
    };
    static constexpr UsualKinds kOfPoints{1, WaysNearby::kMostUsual}, kOfLamps{2, 4};

    /// What is known of as many ways as a place has.
    struct Window {
        std::array<std::uint32_t, WaysNearby::kMostUsual + WaysNearby::kMostOthers> ways;
        std::uint8_t usual = 0, others = 0;
        // The ball that they ended in, and their strengths together over its disk.
        Vec3 centre;
        float radius = 0;
        double strength = 0;
    };
    static Window windowOf(std::span<const ChainSeed> all, std::size_t first, std::size_t size,
                           std::span<const Kind> around, const UsualKinds& usual);

    struct Sorted {
        std::vector<std::uint32_t> codes;  // ascending
        std::vector<ChainSeed> seeds;      // in that order
        std::vector<Window> windows;       // by the first of their ways
    };
    Sorted sorted(std::span<const std::vector<Arrival>> arrivals, const UsualKinds& usual,
                  const ThreadPool& threads) const;
    WaysNearby near(const Sorted& ways, const Vec3& place, const Vec3& side) const;
    /// The first of the kNear codes about that of a place, or of all if they are fewer.
    std::size_t firstNear(std::span<const std::uint32_t> codes, const Vec3& place,
                          const Vec3& side) const;
    /// Puts the ways of all lights together.
    void joinLights(const Lights& lights);

    std::vector<Sorted> byLight_;  // of all lights; empty: none is without an extent
    // Of all lights without an extent together, if there are several, in the order of the codes.
    std::vector<std::uint32_t> codes_;
    std::vector<LightShare> shares_;
    Sorted ofLamps_;
    float half_ = 1.0f;  // of the cube that places lie in
};

}  // namespace lacuna
