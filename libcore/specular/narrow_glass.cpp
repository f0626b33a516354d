// (theory.md, "Next event through glass")
#include "libcore/specular/narrow_glass.h"

#include <cmath>
#include <numbers>

#include "libcore/material/bsdf.h"

namespace lacuna {

namespace {

/// Share of the facets up to kSteepest, by the area that is seen along the normal.
constexpr double kShareNotTooSteep = kSteepest * kSteepest / (1.0 + kSteepest * kSteepest);

/// The normal's x at which the axes across it change. No surface is likely to have
/// exactly this normal.
constexpr double kOtherAxis = 0.6180339887;

Vec3d besideNormal(const Vec3d& n) {
    return std::fabs(n.x) < kOtherAxis ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
}

/// The change of a unit vector v / |v| with that of v.
Vec3d changeOfUnit(const Vec3d& unit, double length, const Vec3d& by) {
    return (by - unit * dot(unit, by)) * (1.0 / length);
}

}  // namespace

FacetSlope sampleFacet(double u1, double u2) {
    const double u = u1 * kShareNotTooSteep, r = std::sqrt(u / (1.0 - u));
    const double angle = 2.0 * std::numbers::pi * u2;
    return {r * std::cos(angle), r * std::sin(angle)};
}

double pdfOfFacet(const FacetSlope& slope, double alpha) {
    const double squared = slope.s * slope.s + slope.t * slope.t;
    // The density over slopes is 1 / (pi alpha^2 (1 + squared)^2), and d slopes = d h / cos^3.
    const double inverseCosine = std::sqrt(1.0 + alpha * alpha * squared);
    const double k = inverseCosine / (alpha * (1.0 + squared));
    return k * k * inverseCosine * (std::numbers::inv_pi / kShareNotTooSteep);
}

MovingNormal facetAbout(const MovingNormal& shading, const FacetSlope& slope, double alpha) {
    const Vec3d& n = shading.at;
    const Vec3d beside = besideNormal(n), c = cross(n, beside);
    const double lengthOfC = length(c);
    const Vec3d s = c * (1.0 / lengthOfC), t = cross(n, s);
    const double alongS = alpha * slope.s, alongT = alpha * slope.t;
    const Vec3d sum = n + s * alongS + t * alongT;
    const double lengthOfSum = length(sum);
    MovingNormal facet{sum * (1.0 / lengthOfSum), {}};
    for (std::size_t i = 0; i < 2; ++i) {
        const Vec3d& nBy = shading.by[i];
        const Vec3d sBy = changeOfUnit(s, lengthOfC, cross(nBy, beside));
        const Vec3d tBy = cross(nBy, s) + cross(n, sBy);
        facet.by[i] = changeOfUnit(facet.at, lengthOfSum, nBy + sBy * alongS + tBy * alongT);
    }
    return facet;
}

std::optional<FacetSlope> facetBetween(const Bsdf& bsdf, const Vec3& toEye, const Vec3& toLight) {
    const Vec3d n(bsdf.ns());
    const Vec3d eye(toEye), light(toLight);
    const bool eyeOutside = dot(eye, Vec3d(bsdf.ng())) > 0.0;
    Vec3d h;
    if (bsdf.bends()) {
        // h lies on the side of the lower index, the outside [Walter07 eq 16].
        h = (eye * double(bsdf.indexOn(eyeOutside)) + light * double(bsdf.indexOn(!eyeOutside))) *
            -1.0;
        const Vec3d outside = eyeOutside ? eye : light, inside = eyeOutside ? light : eye;
        if (!(dot(h, outside) > 0.0 && dot(h, inside) < 0.0)) return std::nullopt;
    } else {
        // A sheet mirrors what its facets reflect.
        h = (eye + light - n * (2.0 * dot(light, n))) * (eyeOutside ? 1.0 : -1.0);
    }
    const double cosine = dot(h, n);
    if (!(cosine > 0.0)) return std::nullopt;
    const Vec3d s = normalize(cross(n, besideNormal(n))), t = cross(n, s);
    const double scale = 1.0 / (cosine * double(bsdf.narrowAlpha()));
    const FacetSlope slope{dot(h, s) * scale, dot(h, t) * scale};
    if (!(std::hypot(slope.s, slope.t) < kSteepest)) return std::nullopt;
    return slope;
}

}  // namespace lacuna
