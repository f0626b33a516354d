// Vertex merging: an eye vertex and the light vertices around it, its photons, taken for one point
// [Georgiev12b, Hachisuka12]. What rows say of it, and which vertices may take part. (theory.md,
// "Merging")
#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "libcore/bidir/path.h"

namespace lacuna {

/// The vertices x_i of a full path, 0 < i < k, at which a row merges it: a function of the path
/// alone. Those whose event is a delta never.
enum class Merges : std::uint8_t {
    Nowhere,
    Everywhere,
    FirstFromEye,   ///< all between x_i and the lens are deltas or scatter narrowly: photon mapping
    BetweenDeltas,  ///< x_{i-1} and x_{i+1} are deltas: what no edge at x_i can be joined for
};

/// What a row merges, and how far it looks.
struct Merging {
    Merges where = Merges::Nowhere;
    double radius = 0;  ///< R of iteration 0, in the scene's unit; 0: from the pixels' footprint
};

/// R of an iteration, counted over all blocks, from that of iteration 0: alpha of [Georgiev12b].
double mergeRadius(double first, std::uint32_t iteration);

inline double mergeArea(double radius) {
    return std::numbers::pi * radius * radius;
}

/// Whether a light subpath's last vertex may be a photon: with asksForPhotons of the eye's part
/// the same as FullPath::mergesAt.
inline bool isPhoton(Subpath light, Merges where) {
    const PathVertex& y = light.back();
    if (y.index == 0 || y.kind != VertexKind::Surface || !y.connectable()) return false;
    return where != Merges::BetweenDeltas || isDelta(light[light.size() - 2].event);
}

/// Whether what the eye sees by a vertex of its walk is what lies where the walk goes on, in the main.
inline bool isNearlySpecular(const PathVertex& z) {
    return isDelta(z.event) || !z.scattersWidely();
}

/// Whether an eye subpath's last vertex may be merged with photons.
inline bool asksForPhotons(Subpath eye, Merges where) {
    const PathVertex& z = eye.back();
    if (where == Merges::Nowhere) return false;
    if (z.kind != VertexKind::Surface || !z.connectable()) return false;
    if (where == Merges::FirstFromEye) {
        return std::ranges::all_of(eye.subspan(1, eye.size() - 2), isNearlySpecular);
    }
    return where != Merges::BetweenDeltas || isDelta(eye[eye.size() - 2].event);
}

/// Whether a photon that lies near enough also lies on what the eye vertex lies on: surfaces about
/// parallel, which it arrived at on one and the same side.
inline bool onSameSurface(const PathVertex& photon, const PathVertex& eye) {
    constexpr float kParallel = 0.7f;  // cosine of 45 degrees
    return dot(photon.ng, eye.ng) > kParallel &&
           dot(photon.ng, photon.toPrevious) * dot(eye.ng, photon.toPrevious) > 0.0f;
}

}  // namespace lacuna
