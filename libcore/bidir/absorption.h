// Absorption of light inside coloured glass (KHR_materials_volume).
//
// Paths know surfaces, not bodies. So the two ends of an edge tell whether it runs inside a body:
// it does if it leaves one of them on the back of an absorbing solid, and that solid gives the
// coefficient. If both ends say so, the mean of the two coefficients holds (they differ only where
// bodies overlap). If neither end says so, nothing is absorbed. That includes edges inside the
// glass between two opaque things or lights. The result is symmetric in the ends, so either walk, a
// connection and a splat give an edge the same transmittance. No density depends on it.
// (theory.md, "Paths and measures")
#pragma once

#include <span>

#include "libcore/bidir/path.h"

namespace lacuna {

/// An end of an edge on a surface, or on none (the material is kNone).
struct EdgeEnd {
    Vec3 position, ng;
    std::uint32_t material;
};

/// transmittance() of an edge between finite vertices, for scenes in which some material absorbs.
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
