// Facets of nearly smooth glass: where one of them refracts a ray, a chain goes on as through smooth glass whose
// normal is turned. (theory.md, "Next event through glass")
#pragma once

#include <array>
#include <optional>

#include "libcore/base/vec.h"

namespace lacuna {

class Bsdf;

/// How a facet is turned against the shading normal: its slopes along two axes across it, over GGX's alpha. One
/// distribution serves all surfaces.
struct FacetSlope {
    double s = 0, t = 0;
};

/// Slopes are no steeper: a surface has few facets beyond, in all directions, so that what they bring to any one is
/// dim. It is left to other techniques.
inline constexpr double kSteepest = 4.0;

/// A draw from that distribution; u1, u2 in [0, 1).
FacetSlope sampleFacet(double u1, double u2);
/// D(h) (h . n) over its integral as far as slopes go: the density of the facet's normal per solid angle
/// [Walter07 eq 33].
double pdfOfFacet(const FacetSlope& slope, double alpha);

/// A unit normal, and its change by two parameters.
struct MovingNormal {
    Vec3d at;
    std::array<Vec3d, 2> by;
};
/// The facet's, on the side of the shading normal.
MovingNormal facetAbout(const MovingNormal& shading, const FacetSlope& slope, double alpha);

/// Of the facet that refracts one unit direction into the other, on different sides of the surface. Empty where
/// none does, or one that is too steep.
std::optional<FacetSlope> facetBetween(const Bsdf& bsdf, const Vec3& toEye, const Vec3& toLight);

}  // namespace lacuna
