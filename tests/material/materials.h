// The grid of tests of the BSDF's contract: material x roughness x angle x side of the surface x
// shading normal x walk.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "libcore/base/sampling.h"
#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf.h"
#include "tests/material/statistics.h"

namespace lacuna::test {

struct Material {
    std::string name;
    Bsdf::Parameters parameters;
};

inline Bsdf::Parameters makeParameters(Rgb color, float metallic, float transmission,
                                       float specular = 1.0f, float ior = 1.5f, bool thin = false) {
    Bsdf::Parameters p;
    p.baseColor = color;
    p.metallic = metallic;
    p.transmission = transmission;
    p.specular = specular;
    p.ior = ior;
    p.thin = thin;
    return p;
}

inline Bsdf::Parameters tinted(Bsdf::Parameters p, Rgb specularColor) {
    p.specularColor = specularColor;
    return p;
}

inline Bsdf::Parameters clearcoated(Bsdf::Parameters p, float weight, float roughness) {
    p.clearcoat = weight;
    p.clearcoatRoughness = roughness;
    return p;
}

inline Vec3 polar(double degrees, double azimuthDegrees) {
    const double theta = degrees * std::numbers::pi / 180,
                 phi = azimuthDegrees * std::numbers::pi / 180;
    return Vec3(
        Vec3d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
}

/// A rotation in which no axis is special.
inline const Frame& world() {
    static const Frame frame(normalize(Vec3{0.36f, -0.48f, 0.8f}));
    return frame;
}

inline Bsdf::Parameters ownClearcoat(Bsdf::Parameters p, float weight, float roughness) {
    p = clearcoated(p, weight, roughness);
    p.clearcoatNormal = world().toWorld(polar(10, 300));
    p.thin = true;  // only for sheets do bins cover directions between the two normals' horizons
    return p;
}

inline Bsdf::Parameters brushed(Bsdf::Parameters p, float anisotropy) {
    p.anisotropy = anisotropy;
    p.tangent = world().toWorld(polar(80, 65)) * 3.0f;  // neither unit nor quite in the surface
    return p;
}

inline Bsdf::Parameters withSheen(Bsdf::Parameters p, Rgb color, float roughness) {
    p.sheenColor = color;
    p.sheenRoughness = roughness;
    return p;
}

inline Bsdf::Parameters leaf(Bsdf::Parameters p, float share, Rgb color) {
    p.diffuseTransmission = share;
    p.diffuseTransmissionColor = color;
    p.thin = true;  // diffuse transmission has no index, and thus no eta^2
    return p;
}

inline Bsdf::Parameters paneOf(Rgb color) {
    Bsdf::Parameters p = makeParameters(color, 0, 1, 1, 1.5f, true);
    p.pane = true;
    return p;
}

/// Every kind of lobe, alone and combined; the test sets the roughness.
inline std::vector<Material> materials() {
    const Rgb white(1.0f), red(0.9f, 0.3f, 0.1f), black(0.0f);
    return {
        {"lambert", makeParameters(red, 0, 0, 0)},
        {"plastic", makeParameters(white, 0, 0)},
        {"plastic half specular, ior 1.8", makeParameters(red, 0, 0, 0.5f, 1.8f)},
        {"coat on black", makeParameters(black, 0, 0)},
        {"metal", makeParameters(red, 1, 0)},
        {"mirror", makeParameters(white, 1, 0)},
        {"glass", makeParameters(white, 0, 1)},
        {"tinted glass, ior 1.1", makeParameters(red, 0, 1, 1, 1.1f)},
        {"glass, ior 1", makeParameters(red, 0, 1, 1, 1.0f)},
        {"thin glass", makeParameters(white, 0, 1, 1, 1.5f, true)},
        {"metal over plastic", makeParameters(red, 0.4f, 0)},
        {"plastic and glass", makeParameters(red, 0, 0.6f, 0.8f, 1.5f)},
        {"everything, solid", makeParameters(red, 0.3f, 0.5f, 1, 1.33f)},
        {"everything, thin", makeParameters(red, 0.3f, 0.5f, 1, 1.33f, true)},
        {"lambert and glass", makeParameters(white, 0, 0.5f, 0)},
        {"plastic with a coloured coat", tinted(makeParameters(red, 0, 0), Rgb(1, 0.2f, 0.4f))},
        {"coloured coat, brighter, on white and glass",
         tinted(makeParameters(white, 0, 0.3f, 0.7f), Rgb(0.5f, 3, 1))},
        {"smooth clearcoat on plastic", clearcoated(makeParameters(white, 0, 0), 1, 0)},
        {"rough clearcoat on metal", clearcoated(makeParameters(red, 1, 0), 0.8f, 0.5f)},
        {"rough clearcoat on lambert", clearcoated(makeParameters(red, 0, 0, 0), 1, 0.6f)},
        {"smooth clearcoat on glass", clearcoated(makeParameters(white, 0, 1), 1, 0)},
        {"rough clearcoat on thin glass",
         clearcoated(makeParameters(red, 0, 1, 1, 1.5f, true), 0.7f, 0.4f)},
        {"rough clearcoat on everything, solid",
         clearcoated(makeParameters(red, 0.3f, 0.5f, 1, 1.33f), 0.6f, 0.5f)},
        {"pane", paneOf(white)},
        {"tinted pane", paneOf(red)},
        {"clearcoat on black", clearcoated(makeParameters(black, 0, 0, 0), 1, 0.3f)},
        {"brushed metal", brushed(makeParameters(red, 1, 0), 0.8f)},
        {"brushed plastic", brushed(makeParameters(white, 0, 0), 0.5f)},
        {"brushed glass", brushed(makeParameters(white, 0, 1), 0.6f)},
        {"brushed everything, thin", brushed(makeParameters(red, 0.3f, 0.5f, 1, 1.33f, true), 1)},
        {"sheen on lambert", withSheen(makeParameters(red, 0, 0, 0), white, 0.3f)},
        {"narrow sheen on white plastic", withSheen(makeParameters(white, 0, 0), white, 0.25f)},
        {"sheen on black", withSheen(makeParameters(black, 0, 0, 0), red, 1)},
        {"sheen on mirror", withSheen(makeParameters(white, 1, 0), Rgb(0.5f, 0.8f, 0), 0.6f)},
        {"sheen on glass", withSheen(makeParameters(white, 0, 1), Rgb(0.2f, 0.4f, 0.9f), 0.5f)},
        {"sheen under clearcoat",
         clearcoated(withSheen(makeParameters(white, 0, 0), white, 0.5f), 0.8f, 0.3f)},
        {"leaf", leaf(makeParameters(red, 0, 0, 0), 0.4f, Rgb(0.2f, 0.9f, 0.1f))},
        {"white leaf under a coat", leaf(makeParameters(white, 0, 0), 0.5f, white)},
        {"all through, from black", leaf(makeParameters(black, 0, 0), 1, red)},
        {"leaf, glass and metal", leaf(makeParameters(red, 0.3f, 0.4f), 0.6f, white)},
        {"leaf with sheen and clearcoat",
         clearcoated(withSheen(leaf(makeParameters(white, 0, 0), 0.5f, white), red, 0.4f), 1, 0)},
        {"smooth clearcoat of its own on plastic", ownClearcoat(makeParameters(white, 0, 0), 1, 0)},
        {"rough clearcoat of its own on metal",
         ownClearcoat(makeParameters(red, 1, 0), 0.8f, 0.5f)},
        {"smooth clearcoat of its own on glass",
         ownClearcoat(makeParameters(white, 0, 1), 0.7f, 0)},
        {"rough clearcoat of its own on a leaf with sheen",
         ownClearcoat(withSheen(leaf(makeParameters(white, 0, 0), 0.5f, white), red, 0.4f), 1,
                      0.4f)},
    };
}

/// alpha = 0, 1e-4 (rounded up), 0.01, 0.09, 0.36, 1.
inline constexpr std::array<float, 6> kRoughness{0.0f, 0.01001f, 0.1f, 0.3f, 0.6f, 1.0f};
/// Only 5 degrees would reveal samples tilted by a hundredth.
inline constexpr std::array<double, 6> kDegrees{0.0, 5.0, 30.0, 60.0, 85.0, 89.9};
/// With ng tilted by 20 degrees towards the known direction, this angle is above ng's plane and
/// below ns's.
inline constexpr double kBelowDegrees = 97.0;

/// Tables for every ior of `materials()`.
inline const AlbedoTables& tables() {
    static const AlbedoTables t = [] {
        std::vector<float> iors;
        for (const Material& m : materials()) {
            iors.push_back(Bsdf::layerIor(m.parameters.ior, m.parameters.specularColor));
        }
        return AlbedoTables(iors);
    }();
    return t;
}

/// One point of the grid.
struct Case {
    std::string name;
    Bsdf bsdf;
    Bsdf::Parameters parameters;
    Vec3 from;    ///< the known direction
    Side side;    ///< the walk that samples
    bool tilted;  ///< ns and ng differ, or the clearcoat has its own normal
    bool front;   ///< `from` is outside, according to ng

    double indexOn(bool outside) const {
        return outside || parameters.thin ? 1.0 : double(parameters.ior);
    }
    BsdfEvaluation evaluate(Vec3 to, ScatterEvent event) const {
        return side == Side::Eye ? bsdf.evaluate(from, to, event) : bsdf.evaluate(to, from, event);
    }
    double pdf(const BsdfEvaluation& e) const {
        return double(side == Side::Eye ? e.pdfWToLight : e.pdfWToEye);
    }
    /// f |to.ng| without the eye walk's eta^2, which must not gain energy. It uses green, in which
    /// the coloured materials are neither black nor white.
    double energy(const BsdfEvaluation& e, Vec3 to) const {
        const bool toFront = dot(to, bsdf.ng()) > 0;
        const double cosine = std::abs(double(dot(to, bsdf.ng())));
        const double scale =
            side == Side::Eye ? std::pow(indexOn(toFront) / indexOn(front), 2) : 1.0;
        return double(e.f.g) * cosine * scale;
    }
};

/// w of bsdf.h, in double from its definition: 1 - 4 m / |toEye . ng|, with m the cosine between ng
/// and the eye's mirror direction about ns.
inline double shareOfNg(Vec3d toEye, Vec3d ng, Vec3d ns) {
    const double side = dot(toEye, ng) > 0 ? 1 : -1;
    const double m = dot(ns * (2 * dot(toEye, ns)) - toEye, ng) * side;
    return std::clamp(1 - 4 * m / std::abs(dot(toEye, ng)), 0.0, 1.0);
}

/// Moments of the weights of an eye walk's samples; their mean is the albedo seen from toEye.
inline Moments albedoSeenFrom(const Bsdf& bsdf, Vec3 toEye, int samples, Random& random) {
    Moments albedo;
    for (int i = 0; i < samples; ++i) {
        const float u0 = random.next(), u1 = random.next(), u2 = random.next();
        const auto s = bsdf.sample(Side::Eye, toEye, u0, u1, u2);
        albedo.add(s ? double(s->evaluation.f.g) * std::abs(double(dot(s->to, bsdf.ng()))) /
                           double(s->evaluation.pdfWToLight)
                     : 0.0);
    }
    return albedo;
}

inline std::vector<Case> grid() {
    std::vector<Case> cases;
    for (const Material& m : materials()) {
        for (const float roughness : kRoughness) {
            std::vector<double> angles(kDegrees.begin(), kDegrees.end());
            angles.push_back(kBelowDegrees);
            for (const double degrees : angles) {
                for (int bits = 0; bits < 8; ++bits) {
                    const bool front = (bits & 1) == 0, tilted = (bits & 2) != 0;
                    if (degrees > 90.0 && !tilted) continue;
                    const Side side = (bits & 4) != 0 ? Side::Light : Side::Eye;
                    Bsdf::Parameters p = m.parameters;
                    p.roughness = roughness;
                    // The roughness along the grain is limited to what quadrature about one half
                    // vector resolves.
                    const float alpha = std::max(1e-3f, roughness * roughness);
                    p.anisotropy = std::min(p.anisotropy, std::sqrt(7 * alpha));
                    // `from` stays on the same side of ng, because ng is tilted towards it.
                    const Vec3 ng = world().toWorld(tilted ? polar(20, 77) : Vec3{0, 0, 1});
                    const Vec3 up = world().toWorld(polar(degrees, 40));
                    cases.push_back({m.name + ", roughness " + std::to_string(roughness) + ", " +
                                         std::to_string(degrees) + " degrees" +
                                         (front ? "" : ", back") + (tilted ? ", tilted" : "") +
                                         (side == Side::Eye ? ", eye walk" : ", light walk"),
                                     Bsdf(p, ng, world().n, tables()), p, front ? up : -up, side,
                                     tilted || lengthSquared(p.clearcoatNormal) > 0, front});
                }
            }
        }
    }
    return cases;
}

}  // namespace lacuna::test
