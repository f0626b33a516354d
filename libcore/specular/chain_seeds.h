// Ways on which light comes over mirrors and through smooth glass, traced once from the lights. A search for chains
// begins with the ways that ended nearby [Fan23]. (theory.md, "Specular chains", "Next event along known ways")
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
    Vec3 end;            ///< where it ended
    Vec3 direction;      ///< unit, from the end to the first vertex
    float distance = 0;  ///< from the end to the first vertex, in metres
    /// Change of the direction with the end, per metre, both by two axes across it.
    std::array<std::array<float, 2>, 2> turn{};
    std::array<SpecularEvent, Chain::kMost> events{};  ///< from the eye's side
    std::uint8_t size = 0;
    /// For a light without a size: the power that comes this way, over what its whole power brings to a square metre of
    /// the sphere around the scene. For lamps and skies: the root of the second moment of walks that run into them this
    /// way, over what all lights bring to such a square metre.
    float strength = 0;

    bool hasEventsOf(const Chain& chain) const;
    /// Unit direction of a way over the same surfaces from the same light that ends at a place nearby. It is exact as
    /// the distance to that place goes to zero.
    Vec3d directionAt(const Vec3d& place) const;
};

/// Ways that ended near a place. Ways of the same events from about the same direction are of one kind.
struct WaysNearby {
    static constexpr std::size_t kMostUsual = 8, kMostOthers = 28;
    std::span<const ChainSeed> all;  ///< of the light, or of all lamps
    // Where they stand in `all`:
    /// One way of each kind that came here; for lamps, of each kind that came more than once.
    std::span<const std::uint32_t> usual;
    std::span<const std::uint32_t> others;  ///< all that came here, then kinds from farther around
    /// Strength of all that came here, per square metre; zero where the place lies outside
    /// of their ball.
    double strength = 0;

    /// An expected number of samples by `strength`. Samples of the same cost are worth most where their number is
    /// proportional to the root of the second moment of what they bring.
    double samples(double fewest) const {
        constexpr double kByStrength = 0.25;
        return strength > 0.0 ? std::clamp(kByStrength * strength, fewest, 1.0) : fewest;
    }
};

class ChainSeeds {
  public:
    /// Traces ways of all lights, the more of a light the more power it has. A
    /// function of the scene.
    ChainSeeds(const Scene& scene, const ThreadPool& threads);

    /// The light of a way that ended near a place, and its share of the power.
    struct LightShare {
        std::uint32_t light;
        float power;  ///< the share of all light that the way stands for
    };
    /// The ways of all lights without an extent that ended near a place, on a surface that looks to `side`. Empty if
    /// there are not several such lights.
    std::span<const LightShare> lightsNear(const Vec3& place, const Vec3& side) const;
    /// The ways of a light without an extent that ended near a place, on a surface that looks to `side`. Empty if none
    /// ended anywhere.
    WaysNearby near(std::uint32_t light, const Vec3& place, const Vec3& side) const;
    /// Likewise the ways of all lights that walks can run into, but seldom do over these ways.
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

    /// A kind of ways: the way that stands for it, and how many ways it has.
    struct Kind {
        std::uint32_t way;
        Vec3 direction;  // of the first one
        int count;
    };
    static bool isOf(const Kind& kind, std::span<const ChainSeed> all, const ChainSeed& way);
    static std::vector<Kind> kindsOf(std::span<const ChainSeed> all, std::size_t first,
                                     std::size_t size);

    /// Which kinds of ways are usual: those with at least so many ways, and how many kinds at most.
    struct UsualKinds {
        int fewestWays;
        std::size_t most;
    };
    static constexpr UsualKinds kOfPoints{1, WaysNearby::kMostUsual}, kOfLamps{2, 4};

    /// The usual and the other ways of kNear ways with successive codes, and their ball.
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
    /// Index of the first of the kNear codes about that of a place; zero if there are fewer codes.
    std::size_t firstNear(std::span<const std::uint32_t> codes, const Vec3& place,
                          const Vec3& side) const;
    /// Fills codes_ and shares_ with the ways of all lights without an extent.
    void joinLights(const Lights& lights);

    std::vector<Sorted> byLight_;  // of all lights; empty: none is without an extent
    // The ways of all lights without an extent together, if there are several, in the
    // order of the codes.
    std::vector<std::uint32_t> codes_;
    std::vector<LightShare> shares_;
    Sorted ofLamps_;
    float half_ = 1.0f;  // of the cube that places lie in
};

}  // namespace lacuna
