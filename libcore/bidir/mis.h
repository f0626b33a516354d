// The balance heuristic over all strategies of one full path: the only place where weights are
// made.
//
//     w_t(x) = n_t p_t(x) r_t(x) / sum_i n_i p_i(x) r_i(x)                            (methods.md
//     1)
//
// Path x_0 (light) .. x_k (lens); strategy t takes the last t vertices from the eye, t = 1 .. k
// + 1. Neighbouring strategies differ in one vertex:  p_{t+1} / p_t = pE(x_{k-t}) / pL(x_{k-t}), so
// the sum is a sweep of ratios in double and products of densities never occur (numerics.md 9, 10).
// Delta events keep their generalised densities in the ratios; strategies that would connect
// through one do not exist (numerics.md 2).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <span>

#include "libcore/bidir/path.h"

namespace lacuna {

/// Longest path in edges that can be asked for.
inline constexpr int kMaxEdges = 254;

/// Who made an edge of a full path.
enum class EdgeMaker : std::uint8_t { LightWalk, EyeWalk, Connection };

/// One end of a connection as the density sees it, whichever walk made the vertex.
struct ConnectionEnd {
    const PathVertex* vertex;
    const PathVertex*
        predecessor;  ///< in this role: towards the light, or towards the lens; may be null
    int count;        ///< s for the light's end, t for the eye's
    Rgb scatter;      ///< f between predecessor and the other end (y_0: emission profile)
    /// Of the edge to the predecessor; Connection where it is not known.
    EdgeMaker maker = EdgeMaker::Connection;
    /// Where a connection made that edge: OpenConnection's tag for this end, or kNone.
    std::uint32_t tagAcross = kNone;
};

/// The edge that a strategy closes a path by.
struct Connection {
    ConnectionEnd eye, light;
    Rgb beta;         ///< throughput that light tracing would have had at the light's end
    double geometry;  ///< G of the edge
    /// Which of the eye vertices that a connection could end at the eye's end is: 1 for the first,
    /// z_1 or what is seen in mirrors and through glass.
    int order;
};

/// What a density keeps for the two ends of a connection in the role that the other walk would have
/// given them: predecessor is then the other end. kNone: nothing.
struct TagsAcross {
    std::uint32_t light = kNone;  ///< of y_{s-1} as an eye vertex
    std::uint32_t eye = kNone;    ///< of z_{t-1} as a light vertex
};

/// Two subpaths whose last vertices see each other: s >= 1, t >= 2.
struct OpenConnection {
    Subpath light, eye;
    Edge edge;  ///< from the light's last vertex to the eye's
    TagsAcross across;
};

/// What MIS believes about the selector: the effective number of samples n r of methods.md that
/// strategy (s, t) has for this connection. A function of the path and of frozen data alone;
/// positive only where the selector can pick the vertex.
class ConnectionDensity {
  public:
    /// For densities that depend on nothing but whether s = 1.
    struct Constants {
        double direct;    ///< s = 1
        double indirect;  ///< s >= 2
    };

    virtual ~ConnectionDensity() = default;
    /// Set: effectiveSamples is never asked.
    virtual std::optional<Constants> constants() const { return std::nullopt; }
    virtual double effectiveSamples(const Connection& connection) const = 0;

    /// Whether surface vertices are to be tagged, once each, before they are part of a path that
    /// is weighted or connected.
    virtual bool tagsVertices() const { return false; }
    /// The tag: a function of the vertex and of frozen data. effectiveSamples must do with vertices
    /// that have none.
    virtual std::uint32_t tagOf(const PathVertex& vertex) const {
        (void)vertex;
        return kNone;
    }
    /// Tags the surface vertices of a whole walk, z_0 or y_0 first, that have no tag yet. To be
    /// replaced where a tag depends on the vertex's neighbours.
    virtual void tagWalk(std::span<PathVertex> walk) const {
        for (PathVertex& v : walk) {
            if (v.kind == VertexKind::Surface && v.tag == kNone) v.tag = tagOf(v);
        }
    }
    /// Fills `across` of each, so that effectiveSamples need not look it up for each of them alone.
    virtual void tagAcross(std::span<OpenConnection> connections) const { (void)connections; }
};

/// How many samples each technique has, as seen from every other one: fixed for an iteration.
struct Techniques {
    bool hit = false;   ///< s = 0: eye paths that run into a light
    double splats = 0;  ///< t = 1: light paths that splat (L); 0: there is no such technique
    const ConnectionDensity* connections = nullptr;  ///< t >= 2, s >= 1; null: none
    /// connections->constants(), looked up once. Set all three by connectThrough.
    std::optional<ConnectionDensity::Constants> constants = std::nullopt;
    bool tags = false;      ///< connections->tagsVertices(), likewise
    int rouletteDepth = 1;  ///< first vertex index (own end = 0) at which roulette is played

    /// Whether there are none but s = 0 and s = 1.
    bool onlyDirect() const {
        return splats == 0.0 && (!connections || (constants && constants->indirect == 0.0));
    }

    void connectThrough(const ConnectionDensity& density) {
        connections = &density;
        constants = density.constants();
        tags = density.tagsVertices();
    }
    /// Tags a whole walk, where the density wants it.
    void tag(std::span<PathVertex> walk) const {
        if (tags) connections->tagWalk(walk);
    }
    void tagAcross(std::span<OpenConnection> open) const {
        if (tags) connections->tagAcross(open);
    }
};

/// A full path with the densities of both walks: what misWeight reads. All arrays by vertex, x_0
/// first; valid up to `edges`.
struct FullPath {
    int edges = 0;
    std::array<const PathVertex*, kMaxEdges + 1> vertex;
    std::array<float, kMaxEdges + 1> lightPdfA;  ///< pL(x_i | x_{i-1}, x_{i-2}), no roulette
    std::array<float, kMaxEdges + 1> eyePdfA;    ///< pE(x_i | x_{i+1}, x_{i+2}), no roulette
    std::array<float, kMaxEdges + 1> survival;   ///< 1 at both ends
    std::array<bool, kMaxEdges + 1> delta;       ///< of the event at x_i on THIS path; not at ends
    std::array<Rgb, kMaxEdges + 1> scatter;      ///< f at x_i (x_0: emission profile)
    Rgb sourceBeta;                              ///< exitance over density at x_0
    bool hittable = false;                       ///< an eye walk can run into this light
    bool splattable = true;                      ///< k = 1 under a punctual light is not splatted
    std::span<const Rgb> absorption;             ///< of the scene, by material (absorption.h)
    /// How many of the first (last) edges the light's (the eye's) walk made.
    int lightEdges = 0, eyeEdges = 0;
    TagsAcross across;  ///< of the edge that a connection made

    /// Of the edge x_i, x_{i+1}.
    EdgeMaker makerOf(int i) const {
        return i < lightEdges          ? EdgeMaker::LightWalk
               : i >= edges - eyeEdges ? EdgeMaker::EyeWalk
                                       : EdgeMaker::Connection;
    }
    /// Whether strategy t (s = edges + 1 - t) could have made this path at all.
    bool exists(int t) const {
        const int s = edges + 1 - t;
        if (s == 0) return hittable;
        if (edges == 1 && t == 1 && !splattable) return false;
        // The connection's two ends scatter smoothly, as the light's point and the lens always do.
        return !delta[s - 1] && !delta[s];
    }
    /// Connection::order where the eye's end is x_i.
    int orderOf(int i) const {
        return 1 + int(std::count(delta.begin() + i + 1, delta.begin() + edges, false));
    }
    /// Roulette in the light's (the eye's) walk for reaching x_i: survival at its predecessor.
    double lightRoulette(int i, int rouletteDepth) const {
        return ifPlayed(i - 1 >= rouletteDepth, survival[std::max(0, i - 1)]);
    }
    double eyeRoulette(int i, int rouletteDepth) const {
        return ifPlayed(edges - i - 1 >= rouletteDepth, survival[std::min(i + 1, edges)]);
    }
    /// The survival, or one. By bits: a branch would be taken the wrong way half of the time.
    static double ifPlayed(bool played, float survival) {
        const std::uint32_t mask = played ? ~0u : 0u;
        return double(std::bit_cast<float>((std::bit_cast<std::uint32_t>(survival) & mask) |
                                           (std::bit_cast<std::uint32_t>(1.0f) & ~mask)));
    }
    /// G of the edge x_i, x_{i+1}. A walk's edge has the direction that the walk drew, which its
    /// densities are made of: the positions at its ends know it to 1e-7 of the scene's size only,
    /// and over a short or grazing edge the cosines of the two differ by percents.
    double geometryOf(int i) const;
    /// Unit, from x_i to x_{i+1}; a walk's edge has the direction that the walk drew.
    Vec3 directionOf(int i) const;
    /// `beta` at x_i, i < k: what light tracing would carry there. Filled by fillLightThroughputs.
    std::array<Rgb, kMaxEdges + 1> beta;
    std::array<double, kMaxEdges + 1> geometry;  ///< geometryOf; filled likewise
    void fillLightThroughputs(int rouletteDepth);
};

/// n_t r_t of strategy t on this path; zero where it does not exist. Reads path.beta where the
/// density has no constants.
double effectiveCount(const FullPath& path, const Techniques& techniques, int t);

/// Weight of the strategy t that made the path (1 <= t <= edges + 1), in [0, 1]. O(k). Fills
/// path.beta where the density asks for it.
double misWeight(FullPath& path, const Techniques& techniques, int t);

}  // namespace lacuna
