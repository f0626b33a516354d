// Vertex merging: an eye vertex and the light vertices around it, its photons, are taken for one
// point [Georgiev12b, Hachisuka12]. This file says what rows ask for, and which vertices may take
// part. (theory.md, "Merging")
#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "libcore/bidir/path.h"

namespace lacuna {

/// The vertices x_i of a full path, 0 < i < k, at which a row merges it: a function of the path
/// alone. A vertex whose event is a delta is never merged.
enum class Merges : std::uint8_t {
    Nowhere,
    Everywhere,
    FirstFromEye,   ///< all between x_i and the lens are deltas or scatter narrowly: photon mapping
    BetweenDeltas,  ///< x_{i-1} and x_{i+1} are deltas: no edge at x_i can be a connection
};

/// Which vertices a row merges, and within which radius.
struct Merging {
    Merges where = Merges::Nowhere;
    double radius = 0;  ///< R of iteration 0, in the scene's unit; 0: from the pixels' footprint
};

/// R of an iteration, counted over all blocks, from `first`, the R of iteration 0 [Georgiev12b].
double mergeRadius(double first, std::uint32_t iteration);

inline double mergeArea(double radius) {
    return std::numbers::pi * radius * radius;
}

/// Whether a light subpath's last vertex may be a photon. Together with asksForPhotons of the eye's
/// part this is FullPath::mergesAt.
inline bool isPhoton(Subpath light, Merges where) {
    const PathVertex& y = light.back();
    if (y.index == 0 || y.kind != VertexKind::Surface || !y.connectable()) return false;
    return where != Merges::BetweenDeltas || isDelta(light[light.size() - 2].event);
}

/// Whether what the eye sees at a vertex is mainly what lies in the direction of its walk's next step.
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

/// Whether a photon within the radius lies on the eye vertex's surface: the normals are about
/// parallel, and the photon arrived on the same side of both surfaces.
inline bool onSameSurface(const PathVertex& photon, const PathVertex& eye) {
    constexpr float kParallel = 0.7f;  // cosine of 45 degrees
    return dot(photon.ng, eye.ng) > kParallel &&
           dot(photon.ng, photon.toPrevious) * dot(eye.ng, photon.toPrevious) > 0.0f;
}

}  // namespace lacuna
