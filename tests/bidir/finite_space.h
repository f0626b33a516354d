// A path space of nine states that can be summed completely (acceptance.md 0): the truth that every
// selector, density and misWeight must reproduce, free of geometry, rays and BSDFs.
//
// States 0 and 1 emit and scatter, 2..7 scatter, 8 is the lens. Walks are asymmetric, absorb, and
// cannot make some transitions; BSDF, emission and visibility have zeros; state 5 is a delta.
// Measures are counts, so densities are probabilities. G is 1 / d^2 of the states' positions.
#pragma once

#include <array>
#include <vector>

#include "libcore/base/rng.h"
#include "libcore/bidir/method.h"
#include "libcore/bidir/mis.h"
#include "libcore/methods/registry.h"

namespace lacuna::test {

class FiniteSpace final : public LightSampler, public PathSpace {
  public:
    static constexpr int kStates = 9, kLens = 8, kEmitters = 2, kMaxEdges = 6;
    static constexpr int kRouletteDepth = 2;

    explicit FiniteSpace(std::uint64_t seed);

    /// Sum over all paths of one to six edges that some strategy of `techniques` can make, by
    /// enumeration.
    Rgb exact(const Techniques& techniques) const;

    void traceLight(Rng& rng, std::vector<PathVertex>& out) const;
    void traceEye(Rng& rng, std::vector<PathVertex>& out) const;
    bool sampleLight(Rng& rng, PathVertex& out) const override;

    void traceEye(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const override;
    Arrival arrival(Subpath light, Subpath eye, bool throughEye) const override;
    bool visible(const PathVertex& light, const PathVertex& eye, RayTally& tally) const override;
    /// A wall all round, as near as puts some states out of sight of a point among them.
    float reach(const Vec3&, const Vec3&, RayTally&) const override { return 2.0f; }

    static int stateOf(const PathVertex& v) { return int(v.position.x * 100.0f); }
    bool visible(int a, int b) const { return visible_[a][b]; }
    /// Densities of both walks along x_0 .. x_k, from the tables alone.
    void fill(const std::vector<int>& states, FullPath& path) const;

    /// f / (p p) of the strategy that closes these subpaths, without weight; zero where blocked.
    Rgb hit(Subpath eye) const;
    Rgb splat(Subpath light) const;
    Rgb connect(Subpath light, Subpath eye) const;
    /// States of the path that joins the two subpaths, x_0 first.
    static std::vector<int> join(Subpath light, Subpath eye);

  private:
    template <class T>
    using Table2 = std::array<std::array<T, kStates>, kStates>;
    template <class T>
    using Table3 = std::array<Table2<T>, kStates>;

    double geometry(int a, int b) const;
    Rgb towards(Subpath light, int to) const;
    PathVertex vertexAt(int state) const;
    void goOn(Side side, Rng& rng, std::vector<PathVertex>& out) const;
    Rgb value(const std::vector<int>& states) const;

    std::array<PathVertex, kStates> canonical_;
    std::array<double, kEmitters> sourcePmf_{};
    std::array<Rgb, kEmitters> exitance_{};
    std::array<std::array<Rgb, kStates>, kEmitters> profile_{};     // [x_0][x_1]
    std::array<std::array<double, kStates>, kEmitters> emitPmf_{};  // [x_0][x_1]
    std::array<double, kStates> lensPmf_{}, importance_{};          // [z_1]
    Table3<Rgb> scatter_{};      // [towards light][here][towards eye]
    Table3<double> lightPmf_{};  // [from][here][to]
    Table3<double> eyePmf_{};    // [from][here][to]
    Table2<bool> visible_{};
    std::array<double, kStates> survival_{};
    std::array<bool, kStates> delta_{};
};

/// Mean and standard error over iterations of one method on the space, per channel mean.
struct FiniteEstimate {
    double truth = 0, mean = 0, standardError = 0;
    std::uint64_t iterations = 0;
};

/// Runs `row` through the integrator's sequence (freeze, light pass, prepare, eye pass, observe)
/// with `pixels` eye paths per iteration, until the standard error falls to `relativeError` of the
/// truth.
FiniteEstimate estimate(const FiniteSpace& space, const MethodRow& row,
                        const std::vector<std::string>& settings, std::uint64_t seed,
                        double relativeError);

}  // namespace lacuna::test
