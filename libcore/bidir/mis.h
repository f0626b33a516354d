// The weights over all strategies of one full path: the only place where they are made.
//
//     w_t(x) = (n_t p_t(x) r_t(x))^b / sum_i (n_i p_i(x) r_i(x))^b            (theory.md, "Weights")
//
// b = 1, the balance heuristic, or for direct light 2, the power heuristic.
// Path x_0 (light) .. x_k (lens); strategy t takes the last t vertices from the eye, t = 1 .. k
// + 1. Neighbouring strategies differ in one vertex: p_{t+1} / p_t = pE(x_{k-t}) / pL(x_{k-t}), so the sum is a sweep
// of ratios in double. Products of densities, which leave a float's range within ten vertices, never occur. A merge at
// x_i is strategy t = k - i with one more vertex from the eye, so it stands beside that strategy in the sweep.
#pragma once

#include <optional>

#include "libcore/bidir/density.h"
#include "libcore/bidir/full_path.h"
#include "libcore/bidir/light_sampler.h"
#include "libcore/bidir/sharing.h"

namespace lacuna {

class KnownWays;
class RefractedLamps;

/// The technique that made a path, with t vertices from the eye.
struct Technique {
    enum class By : std::uint8_t {
        Strategy,  ///< s = edges + 1 - t from the light
        Merge,     ///< of the light's last vertex with the eye's
        Chain,     ///< specular chain, which no other technique makes (specular_chains.h)
        Refraction,  ///< next event through glass (refracted_lamps.h), along known ways (known_ways.h)
    };
    int t;
    By by = By::Strategy;

    Technique(int t_, By by_ = By::Strategy) : t(t_), by(by_) {}
    bool merges() const { return by == By::Merge; }
    bool chains() const { return by == By::Chain; }
    bool refracts() const { return by == By::Refraction; }
    /// s: index of the first vertex of the eye's part (merges: of the vertex that both walks have).
    int firstOfEye(int edges) const { return edges + 1 - t; }
    bool operator==(const Technique&) const = default;
};

/// How many samples each technique has in all weights. Fixed for an iteration.
struct TechniqueCounts {
    bool hit = false;   ///< s = 0: eye paths that run into a light
    double splats = 0;  ///< t = 1: light paths that splat (L); 0: there is no such technique
    const ConnectionDensity* connections = nullptr;  ///< t >= 2, s >= 1; null: none
    /// connections->constants(), looked up once. connectThrough sets it, and connections,
    /// labels, squared and seen.
    std::optional<ConnectionDensity::Constants> constants = std::nullopt;
    bool labels = false;                          ///< connections->keepsLabels(), likewise
    SquaredLights squared = SquaredLights::None;  ///< connections->squaredLights(), likewise
    /// Its seenSamples multiply the count of s = 1. Null: s = 1 draws y_0 as light walks do.
    const LightSampler* seen = nullptr;
    Merges merges = Merges::Nowhere;  ///< where paths are merged
    /// n_m pi R^2 of a merge: light subpaths times the area around an eye vertex in which photons count. Times the
    /// densities of both walks at x_i it counts like n r.
    double mergeSamples = 0;
    const RefractedLamps* refractedLamps = nullptr;  ///< null: no next event through glass
    const KnownWays* knownWays = nullptr;            ///< null: no next event along known ways
    Sharing sharing = {};                            ///< of eye walks, by pixels
    int rouletteDepth = 1;  ///< first vertex index (own end = 0) at which roulette is played

    /// Whether there are no merges and no strategies but s = 0 and s = 1.
    bool onlyDirect() const {
        return splats == 0.0 && merges == Merges::Nowhere && !connectsIndirect();
    }
    /// Whether there are strategies with t >= 2 and s >= 2.
    bool connectsIndirect() const {
        return connections && !(constants && constants->indirect == 0.0);
    }

    void connectThrough(const ConnectionDensity& density, const LightSampler& lights) {
        connections = &density;
        constants = density.constants();
        labels = density.keepsLabels();
        squared = density.squaredLights();
        seen = density.lamps() == Lamps::Seen ? &lights : nullptr;
    }
    /// The factor that n r of s = 1 is still to be multiplied by, from y_0 and the eye's end.
    double samplesOfLamp(const PathVertex& light, const PathVertex& eye) const {
        return seen ? seen->seenSamples(light, eye) : 1.0;
    }
    /// Labels a whole walk, where the density keeps labels: once, before anything is closed.
    void labelWalk(std::span<PathVertex> walk) const {
        if (labels) connections->labelWalk(walk);
    }
    void labelEnds(std::span<OpenConnection> open) const {
        if (labels) connections->labelEnds(open);
    }
};

/// n_t r_t of strategy t on this path; zero where it does not exist. Reads path.beta where the
/// density has no constants.
double effectiveCount(const FullPath& path, const TechniqueCounts& counts, int t);

/// n_m pi R^2 of the merge at x_i, 0 < i < edges; zero where it does not exist.
inline double mergedSamples(const FullPath& path, const TechniqueCounts& counts, int i) {
    return path.mergesAt(i, counts.merges) ? counts.mergeSamples : 0.0;
}

/// Samples of next event through glass or along known ways, relative to the density of s = 0. Zero where neither
/// makes the path.
double refractedSamples(const FullPath& path, const TechniqueCounts& counts);

/// Weight of the technique that made the path (1 <= t <= edges + 1; merges: 2 <= t <= edges), in
/// [0, 1]. O(k). Fills path.beta where the density asks for it.
double misWeight(FullPath& path, const TechniqueCounts& counts, Technique made);

}  // namespace lacuna
