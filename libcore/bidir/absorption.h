// What coloured glass takes from light on its way through it (KHR_materials_volume).
//
// Paths know surfaces, not bodies, so an edge's ends say whether it runs inside one: an end that
// the edge leaves on the back of an absorbing solid says that it does, and by what coefficient.
// Where both ends say so, the mean of the two holds (they are the same but where bodies overlap).
// Where neither does, nothing is absorbed: between two opaque things, or lights, in the glass too.
// This is symmetric in the ends, so whatever makes the edge (either walk, a connection, a splat)
// carries the same; no density knows of it. (theory.md, "Paths and measures")
#pragma once

#include <span>

#include "libcore/bidir/path.h"

namespace lacuna {

/// An end of an edge on a surface, or on none (the material is kNone).
struct EdgeEnd {
    Vec3 position, ng;
    std::uint32_t material;
};

/// As transmittance, where something in the scene absorbs.
Rgb transmittanceInside(std::span<const Rgb> absorption, const EdgeEnd& a, Vec3 direction,
                        const EdgeEnd& b);

/// Share of the light that the edge from `a` along the unit `direction` to `b` lets through:
/// exp(-sigma d) [Beer-Lambert]. `absorption`: sigma by material, per scene unit; empty where no
/// material absorbs. Edges to infinity run through no body.
inline Rgb transmittance(std::span<const Rgb> absorption, const PathVertex& a, Vec3 direction,
                         const PathVertex& b) {
    if (absorption.empty() || a.infinite() || b.infinite()) return Rgb(1.0f);
    const auto end = [](const PathVertex& v) { return EdgeEnd{v.position, v.ng, v.material}; };
    return transmittanceInside(absorption, end(a), direction, end(b));
}

}  // namespace lacuna
