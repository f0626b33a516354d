// A full path x_0 (light) .. x_k (lens), with the densities of both walks. Weights are
// computed from it. (theory.md, "Paths and measures")
//
// Delta events keep their generalised densities; strategies that would connect through one do not
// exist.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "libcore/bidir/merging.h"
#include "libcore/bidir/path.h"

namespace lacuna {

/// Largest number of edges that a path may have.
inline constexpr int kMaxEdges = 254;

/// Density of a path by next event through glass or along known ways, over its density by an eye walk that hits the
/// light (s = 0, without roulette). Zero where next event cannot make the path (refracted_lamps.h, known_ways.h). If no
/// eye walk hits the light, the ratio is to an eye walk whose density at x_0 is FullPath::eyePdfA.
struct OverChain {
    double ratio = 0.0;
    int vertices = 0;  ///< of the chain
};

/// All arrays are indexed by vertex, x_0 first, and valid up to `edges`. Filled while a path is
/// closed (close.h).
struct FullPath {
    template <class T>
    using PerVertex = std::array<T, std::size_t(kMaxEdges) + 1>;

    int edges = 0;
    PerVertex<const PathVertex*> vertex;
    PerVertex<float> lightPdfA;       ///< pL(x_i | x_{i-1}, x_{i-2}), no roulette
    PerVertex<float> eyePdfA;         ///< pE(x_i | x_{i+1}, x_{i+2}), no roulette
    PerVertex<float> survival;        ///< 1 at both ends
    PerVertex<bool> delta;            ///< of the event at x_i on THIS path; false at ends
    PerVertex<Rgb> scatter;           ///< f at x_i (x_0: emission profile)
    PerVertex<Label> asLight;         ///< label of x_i as the end of a light subpath
    PerVertex<Label> asEye;           ///< and of an eye subpath; kNone: not known
    Rgb sourceBeta;                   ///< exitance over density at x_0
    bool hittable = false;            ///< an eye walk can run into this light
    bool splattable = true;           ///< k = 1 under a punctual light is not splatted
    std::span<const Rgb> absorption;  ///< of the scene, by material (absorption.h)
    OverChain refracted;
    /// How many first edges the light's walk made, and how many last edges the eye's walk made.
    int lightEdges = 0, eyeEdges = 0;
    /// Merges: the last vertex of the light's walk. It stands in the place of x_i, i = lightEdges,
    /// which is the eye's vertex. Null for all other paths.
    const PathVertex* photon = nullptr;

    /// Whether strategy t (s = edges + 1 - t) could have made this path at all.
    bool exists(int t) const {
        const int s = edges + 1 - t;
        if (s == 0) return hittable;
        if (edges == 1 && t == 1 && !splattable) return false;
        // The connection's two ends scatter smoothly, as the light's point and the lens always do.
        return !delta[std::size_t(s - 1)] && !delta[std::size_t(s)];
    }
    /// Whether a row that merges as `where` says merges this path at x_i, 0 < i < edges.
    bool mergesAt(int i, Merges where) const {
        const auto n = std::size_t(i);
        if (delta[n] || where == Merges::Nowhere) return false;
        if (where == Merges::FirstFromEye) return isSeenNearlySpecularly(i);
        return where != Merges::BetweenDeltas || (delta[n - 1] && delta[n + 1]);
    }
    /// Whether all vertices between x_i and the lens are deltas or scatter narrowly.
    bool isSeenNearlySpecularly(int i) const {
        for (int j = i + 1; j < edges; ++j) {
            if (!delta[std::size_t(j)] && vertex[std::size_t(j)]->scattersWidely()) return false;
        }
        return true;
    }
    /// Whether the light shines on what the lens sees, itself or as in a mirror.
    bool isDirectLight() const { return isSeenNearlySpecularly(1); }
    /// Connection::order where the eye's end is x_i.
    int orderOf(int i) const {
        return 1 + int(std::count(delta.begin() + i + 1, delta.begin() + edges, false));
    }
    /// Number of delta events behind x_0 before the first other event; zero where only the lens follows them.
    int deltasBehindLight() const {
        int i = 1;
        while (i < edges && delta[std::size_t(i)]) ++i;
        return i < edges ? i - 1 : 0;
    }
    /// Probability that roulette lets the light's (the eye's) walk reach x_i: the survival at the
    /// vertex before x_i in that walk.
    double lightRoulette(int i, int rouletteDepth) const {
        return ifPlayed(i - 1 >= rouletteDepth, survival[std::size_t(std::max(0, i - 1))]);
    }
    double eyeRoulette(int i, int rouletteDepth) const {
        return ifPlayed(edges - i - 1 >= rouletteDepth,
                        survival[std::size_t(std::min(i + 1, edges))]);
    }
    /// G of the edge x_i, x_{i+1}. A walk's edge has the direction that the walk drew, which
    /// its densities are made of. The positions at its ends give that direction only to 1e-7
    /// of the scene's size. Over a short or grazing edge the cosines of the two directions
    /// differ by percents.
    double geometryOf(int i) const;
    /// Unit, from x_i to x_{i+1}; a walk's edge has the direction that the walk drew.
    Vec3 directionOf(int i) const;
    /// x_{i+1} as the light's walk left it. That walk must have made the edge from x_i.
    const PathVertex& lightsEnd(int i) const {
        return photon && i + 1 == lightEdges ? *photon : *vertex[std::size_t(i) + 1];
    }

    /// `beta` at x_i, i < k: what light tracing would carry there. Filled by fillLightThroughputs.
    PerVertex<Rgb> beta;
    PerVertex<double> geometry;  ///< geometryOf; filled likewise
    /// Fills beta and geometry from the densities, BSDF values and survivals of the path.
    void fillLightThroughputs(int rouletteDepth);

  private:
    /// `survival` where roulette is played, else one. It selects by bits, because a branch would be
    /// mispredicted half of the time.
    static double ifPlayed(bool played, float survival) {
        const std::uint32_t mask = played ? ~0u : 0u;
        return double(std::bit_cast<float>((std::bit_cast<std::uint32_t>(survival) & mask) |
                                           (std::bit_cast<std::uint32_t>(1.0f) & ~mask)));
    }
};

}  // namespace lacuna
