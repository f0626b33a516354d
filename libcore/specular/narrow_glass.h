// Facets of nearly smooth glass: where one of them refracts a ray, a chain goes on as through smooth glass whose
// normal is turned. (theory.md, "Next event through glass")
#pragma once

#include <array>
#include <optional>

#include "libcore/base/vec.h"

namespace lacuna {

class Bsdf;

/// A facet's slopes against the shading normal, along two axes across it, over GGX's alpha. So one distribution
/// serves all surfaces.
struct FacetSlope {
    double s = 0, t = 0;
};

/// The steepest slope. A surface has few steeper facets, and they look in all directions, so the light that they bring
/// to any one place is dim. It is left to other techniques.
inline constexpr double kSteepest = 4.0;

/// Draws a facet from that distribution; u1, u2 in [0, 1).
FacetSlope sampleFacet(double u1, double u2);
/// Density (pdfW) of the facet's normal h: D(h) (h . n) over its integral up to kSteepest [Walter07 eq 33].
double pdfOfFacet(const FacetSlope& slope, double alpha);

/// A unit normal, and its change by two parameters.
struct MovingNormal {
    Vec3d at;
    std::array<Vec3d, 2> by;
};
/// The facet's normal, on the side of the shading normal.
MovingNormal facetAbout(const MovingNormal& shading, const FacetSlope& slope, double alpha);

/// The slope of the facet that refracts one unit direction into the other, on different sides of the surface. Empty
/// where no facet does, or only one that is too steep.
std::optional<FacetSlope> facetBetween(const Bsdf& bsdf, const Vec3& toEye, const Vec3& toLight);

}  // namespace lacuna
