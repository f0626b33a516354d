// Compares with the textbook: the published formulas in double and local coordinates, independent of how the renderer
// arranges them. Also, delta events are limits of narrow lobes (numerics.md, "Deltas").
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "libcore/material/fresnel.h"
#include "tests/material/materials.h"
#include "tests/material/statistics.h"

namespace lacuna::test {
namespace {

constexpr double kPiD = std::numbers::pi;

double textbookD(double alpha, double cosine) {
    const double c2 = cosine * cosine, t = (1 - c2) / c2;
    return 1 / (kPiD * alpha * alpha * c2 * c2 * std::pow(1 + t / (alpha * alpha), 2));
}
double lambda(double alpha, double cosine) {
    const double t2 = 1 / (cosine * cosine) - 1;
    return (std::sqrt(1 + alpha * alpha * t2) - 1) / 2;
}
/// Fresnel through Snell's law and the two polarisations.
double textbookFresnel(double cosine, double eta) {
    const double sine = std::sqrt(1 - cosine * cosine) / eta;
    if (sine >= 1) {
        return 1;
    }
    const double ct = std::sqrt(1 - sine * sine);
    const double s = (cosine - eta * ct) / (cosine + eta * ct);
    const double p = (eta * cosine - ct) / (eta * cosine + ct);
    return (s * s + p * p) / 2;
}

struct Reference {
    double f = 0, pdfToLight = 0, pdfToEye = 0;
};

/// Reflection [Walter07 eq 20] and refraction [eq 21], radiance convention; n = +z, z > 0 outside.
Reference glassReference(Vec3d e, Vec3d l, double alpha, double ior) {
    const double etaE = e.z > 0 ? 1 : ior, etaL = l.z > 0 ? 1 : ior;
    const bool reflects = e.z * l.z > 0;
    Vec3d h = normalize(reflects ? e + l : -(e * etaE + l * etaL));
    h = h.z < 0 ? -h : h;
    Reference r;
    if (dot(e, h) * e.z <= 0 || dot(l, h) * l.z <= 0) {
        return r;
    }
    const double eh = std::abs(dot(e, h)), lh = std::abs(dot(l, h));
    const double ce = std::abs(e.z), cl = std::abs(l.z);
    const double d = textbookD(alpha, h.z);
    const double fresnel = textbookFresnel(eh, e.z > 0 ? ior : 1 / ior);
    const double g2 = 1 / (1 + lambda(alpha, ce) + lambda(alpha, cl));
    const double visibleE = d * eh / (1 + lambda(alpha, ce)) / ce;
    const double visibleL = d * lh / (1 + lambda(alpha, cl)) / cl;
    if (reflects) {
        r.f = fresnel * d * g2 / (4 * ce * cl);
        r.pdfToLight = fresnel * visibleE / (4 * eh);
        r.pdfToEye = fresnel * visibleL / (4 * lh);
        return r;
    }
    const double s = etaE * dot(e, h) + etaL * dot(l, h);
    r.f = eh * lh / (ce * cl) * etaE * etaE * (1 - fresnel) * g2 * d / (s * s);
    r.pdfToLight = (1 - fresnel) * visibleE * etaL * etaL * lh / (s * s);
    r.pdfToEye = (1 - fresnel) * visibleL * etaE * etaE * eh / (s * s);
    return r;
}

Vec3d randomDirection(Random& random) {
    const double z = 2 * random.real() - 1, phi = 2 * kPiD * random.real();
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}
/// A direction above the plane z = 0, not quite grazing.
Vec3d randomAbove(Random& random) {
    Vec3d d = randomDirection(random);
    d.z = std::abs(d.z) + 0.01;
    return normalize(d);
}

TEST(BsdfReference, GlassFollowsWalter) {
    Random random(21);
    int refracted = 0;
    for (const double ior : {1.1, 1.5, 2.4}) {
        for (const double roughness : {0.2, 0.5, 1.0}) {
            Bsdf::Parameters p = makeParameters(Rgb(1.0f), 0, 1, 1, float(ior));
            p.roughness = float(roughness);
            const Bsdf bsdf(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
            for (int i = 0; i < 4000; ++i) {
                const Vec3 e(randomDirection(random)), l(randomDirection(random));
                if (std::min(std::abs(e.z), std::abs(l.z)) < 0.01f) {
                    continue;
                }
                const Reference r = glassReference(
                    Vec3d(e), Vec3d(l), double(p.roughness) * double(p.roughness), double(p.ior));
                const BsdfEvaluation v = bsdf.evaluate(e, l);
                // Where the microfacet is nearly grazing, 1 - F itself is small and suffers from rounding.
                const auto near = [](double x) { return 1e-3 * x + 1e-5; };
                ASSERT_NEAR(double(v.f.r), r.f, near(r.f)) << ior << " " << roughness;
                ASSERT_NEAR(double(v.pdfWToLight), r.pdfToLight, near(r.pdfToLight));
                ASSERT_NEAR(double(v.pdfWToEye), r.pdfToEye, near(r.pdfToEye));
                refracted += e.z * l.z < 0 && r.f > 0;
            }
        }
    }
    EXPECT_GT(refracted, 1000);
}

TEST(BsdfReference, MetalAndThinGlass) {
    Random random(22);
    const Rgb f0(0.9f, 0.5f, 0.1f);
    for (const double roughness : {0.2, 0.5, 1.0}) {
        Bsdf::Parameters p = makeParameters(f0, 1, 0);
        p.roughness = float(roughness);
        const Bsdf metal(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
        p = makeParameters(f0, 0, 1, 1, 1.5f, true);
        p.roughness = float(roughness);
        const Bsdf thin(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
        const double alpha = double(p.roughness) * double(p.roughness);
        for (int i = 0; i < 4000; ++i) {
            const Vec3d e = randomAbove(random), l = randomAbove(random);
            const Vec3d h = normalize(e + l);
            const double eh = dot(e, h);
            const double lobe = textbookD(alpha, h.z) /
                                (1 + lambda(alpha, e.z) + lambda(alpha, l.z)) / (4 * e.z * l.z);
            const double density = textbookD(alpha, h.z) / (1 + lambda(alpha, e.z)) / (4 * e.z);
            const double schlickF = 0.1 + 0.9 * std::pow(1 - eh, 5);
            const BsdfEvaluation m = metal.evaluate(Vec3(e), Vec3(l));
            ASSERT_NEAR(double(m.f.b), lobe * schlickF, 1e-3 * lobe);
            ASSERT_NEAR(double(m.pdfWToLight), density, 1e-3 * density);
            const double fresnel = textbookFresnel(eh, 1.5);
            const BsdfEvaluation r = thin.evaluate(Vec3(e), Vec3(l));
            ASSERT_NEAR(double(r.f.b), lobe * fresnel, 1e-3 * lobe);
            // Transmission from either side.
            const BsdfEvaluation t = thin.evaluate(Vec3(e), Vec3(Vec3d{l.x, l.y, -l.z}));
            const BsdfEvaluation u = thin.evaluate(Vec3(Vec3d{e.x, e.y, -e.z}), Vec3(l));
            ASSERT_NEAR(double(t.f.b), lobe * (1 - fresnel) * 0.1, 1e-3 * lobe);
            ASSERT_NEAR(double(u.f.b), double(t.f.b), 1e-5 * lobe);
            ASSERT_NEAR(double(t.pdfWToLight), density * (1 - fresnel), 1e-3 * density);
        }
    }
}

// The delta event is the limit of the narrowest rough lobe: it has the same ratio of the two densities and the same f /
// pdfW. For refraction the ratio of densities is (eta_l / eta_e)^2 |l.ns| / |e.ns|.
TEST(BsdfReference, DeltaEventsAreTheNarrowLimit) {
    int compared = 0;
    for (const Material& m : materials()) {
        if (m.parameters.pane) continue;  // rough glass is no pane
        for (const double degrees : {0.0, 25.0, 38.0, 55.0, 75.0}) {
            for (const bool tilted : {false, true}) {
                for (const bool front : {true, false}) {
                    Bsdf::Parameters p = m.parameters;
                    const Vec3 ng = tilted ? world().toWorld(polar(12, 200)) : world().n;
                    p.roughness = 0;
                    const Bsdf delta(p, ng, world().n, tables());
                    p.roughness = 0.01001f;
                    if (p.clearcoatRoughness == 0) {
                        p.clearcoatRoughness = p.roughness;
                    }
                    const Bsdf rough(p, ng, world().n, tables());
                    const Vec3 up = world().toWorld(polar(degrees, 10));
                    const Vec3 from = front ? up : -up;
                    for (const float u : {0.0f, 0.5f, 0.8f, 0.9999f}) {
                        const auto s = delta.sample(Side::Eye, from, u, 0.5f, 0.5f);
                        if (!s || !isDelta(s->event)) {
                            continue;
                        }
                        const BsdfEvaluation& d = s->evaluation;
                        const BsdfEvaluation r = rough.evaluate(from, s->to);
                        if (p.ior == 1.0f && s->event == ScatterEvent::DeltaTransmission) {
                            EXPECT_EQ(rough.evaluate(from, s->to, s->event).f, d.f);
                            continue;
                        }
                        SCOPED_TRACE(m.name + " " + std::to_string(degrees) + " " +
                                     std::to_string(front) + std::to_string(tilted));
                        ASSERT_GT(r.pdfWToLight, 1e3f);
                        EXPECT_NEAR(r.pdfWToLight / r.pdfWToEye / (d.pdfWToLight / d.pdfWToEye), 1,
                                    0.01);
                        EXPECT_NEAR(r.f.r / r.pdfWToLight / (d.f.r / d.pdfWToLight), 1, 0.01);
                        EXPECT_NEAR(r.f.b / r.pdfWToEye / (d.f.b / d.pdfWToEye), 1, 0.01);
                        ++compared;
                    }
                }
            }
        }
    }
    EXPECT_GT(compared, 400);
}

/// [Heitz14 eq 85] and Smith's Lambda of a surface with alpha `along` in x and `across` in y.
double brushedD(Vec3d h, double along, double across) {
    const double q = std::pow(h.x / along, 2) + std::pow(h.y / across, 2) + h.z * h.z;
    return 1 / (kPiD * along * across * q * q);
}
double brushedLambda(Vec3d v, double along, double across) {
    const double slope2 = (std::pow(v.x * along, 2) + std::pow(v.y * across, 2)) / (v.z * v.z);
    return (std::sqrt(1 + slope2) - 1) / 2;
}

TEST(BsdfReference, BrushedMetalIsRougherAlongItsGrain) {
    Random random(28);
    for (const double roughness : {0.3, 0.6}) {
        for (const double anisotropy : {0.3, 1.0}) {
            Bsdf::Parameters p = makeParameters(Rgb(1.0f), 1, 0);
            p.roughness = float(roughness);
            p.anisotropy = float(anisotropy);
            p.tangent = {-2, 0, 5};  // only its part in the surface counts, and its sign does not
            const Bsdf metal(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
            const double across = roughness * roughness;
            const double along = across + (1 - across) * anisotropy * anisotropy;
            for (int i = 0; i < 2000; ++i) {
                const Vec3d e = randomAbove(random), l = randomAbove(random);
                const Vec3d h = normalize(e + l);
                const double le = brushedLambda(e, along, across),
                             ll = brushedLambda(l, along, across);
                const double d = brushedD(h, along, across);
                const double f = d / (1 + le + ll) / (4 * e.z * l.z);
                const double density = d / (1 + le) / (4 * e.z);
                const BsdfEvaluation found = metal.evaluate(Vec3(e), Vec3(l));
                ASSERT_NEAR(double(found.f.g), f, 2e-3 * f);
                ASSERT_NEAR(double(found.pdfWToLight), density, 2e-3 * density);
            }
        }
    }
}

TEST(BsdfReference, SheenIsCharlies) {
    Random random(29);
    for (const double roughness : {0.4, 0.7, 1.0}) {
        Bsdf::Parameters p = withSheen(makeParameters(Rgb(0.0f), 0, 0, 0), Rgb(1, 0.5f, 0), 0);
        p.sheenRoughness = float(roughness);
        const Bsdf cloth(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
        const double alpha = roughness * roughness, k = std::pow(1 - alpha, 2);
        // [Estevez17, table 1], exponents as printed.
        const double coefficients[5] = {
            k * 25.3245 + (1 - k) * 21.5473, k * 3.32435 + (1 - k) * 3.82987,
            k * 0.16801 + (1 - k) * 0.19823, k * -1.27393 + (1 - k) * -1.97760,
            k * -4.85967 + (1 - k) * -4.32054};
        const auto fit = [&](double x) {
            const auto& c = coefficients;
            return c[0] / (1 + c[1] * std::pow(x, c[2])) + c[3] * x + c[4];
        };
        const auto shadow = [&](double cosine) {
            return cosine < 0.5 ? std::exp(fit(cosine)) : std::exp(2 * fit(0.5) - fit(1 - cosine));
        };
        for (int i = 0; i < 2000; ++i) {
            const Vec3d e = randomAbove(random), l = randomAbove(random);
            const double hz = normalize(e + l).z, sine = std::sqrt(std::max(0.0, 1 - hz * hz));
            const double d = (2 + 1 / alpha) * std::pow(sine, 1 / alpha) / (2 * kPiD);
            const double f = d / ((1 + shadow(e.z) + shadow(l.z)) * 4 * e.z * l.z);
            const BsdfEvaluation found = cloth.evaluate(Vec3(e), Vec3(l));
            ASSERT_NEAR(double(found.f.r), f, 1e-3 * f + 1e-6);
            ASSERT_NEAR(double(found.f.g), f / 2, 1e-3 * f + 1e-6);
            ASSERT_EQ(found.f.b, 0.0f);
        }
    }
}

// A sheen leaves to the layers under it what it does not reflect. White sheen on white reflects no more than arrives,
// however narrow it is.
TEST(BsdfReference, SheenOnWhiteGainsNothing) {
    Random random(30);
    for (const float roughness : {0.0f, 0.1f, 0.2f, 0.5f, 1.0f}) {
        const Bsdf cloth(withSheen(makeParameters(Rgb(1.0f), 0, 0, 0), Rgb(1.0f), roughness),
                         world().n, world().n, tables());
        for (const double degrees : {0.0, 40.0, 80.0, 88.0, 89.9}) {
            const Vec3 eye = world().toWorld(polar(degrees, 30));
            const Moments seen = albedoSeenFrom(cloth, eye, 40000, random);
            SCOPED_TRACE(std::to_string(roughness) + " " + std::to_string(degrees));
            EXPECT_LT(seen.mean(), 1.002 + 5 * seen.standardError());
            EXPECT_GT(seen.mean(), 0.4);
        }
    }
}

TEST(BsdfReference, LeavesDivideTheirBase) {
    const Rgb above(0.8f, 0.4f, 0.2f), below(0.1f, 0.6f, 0.9f);
    const Vec3 n = world().n, e = world().toWorld(polar(30, 10));
    for (const float share : {0.25f, 1.0f}) {
        const Bsdf bsdf(leaf(makeParameters(above, 0, 0, 0), share, below), n, n, tables());
        for (const double degrees : {10.0, 70.0}) {
            const Vec3 l = world().toWorld(polar(degrees, 250));
            const auto near = [](const Rgb& found, const Rgb& expected) {
                EXPECT_NEAR(found.r, expected.r, 1e-5);
                EXPECT_NEAR(found.g, expected.g, 1e-5);
                EXPECT_NEAR(found.b, expected.b, 1e-5);
            };
            near(bsdf.evaluate(e, l).f, above * ((1 - share) * kInvPi));
            near(bsdf.evaluate(e, -l).f, below * (share * kInvPi));
            near(bsdf.evaluate(-e, l).f, below * (share * kInvPi));
        }
        EXPECT_EQ(bsdf.isDiffuse(), share < 1.0f);
        EXPECT_TRUE(bsdf.transmitsDiffusely() && bsdf.transmits());
    }
}

// A smooth clearcoat of weight 1 with its own normal mirrors about that normal as Fresnel says. The base keeps the
// rest, about its own normal.
TEST(BsdfReference, ClearcoatOfItsOwnMirrorsAboutItsNormal) {
    const Vec3 n = world().n, coat = world().toWorld(polar(15, 120));
    Bsdf::Parameters p = clearcoated(makeParameters(Rgb(0.5f), 0, 0, 0), 1, 0);
    p.clearcoatNormal = coat;
    const Bsdf bsdf(p, n, n, tables());
    for (const double degrees : {10.0, 40.0, 65.0}) {
        const Vec3 e = world().toWorld(polar(degrees, 80));
        const float cosine = dot(e, coat);
        const Vec3 mirrored = coat * (2 * cosine) - e;
        const BsdfEvaluation d = bsdf.evaluate(e, mirrored, ScatterEvent::DeltaReflection);
        // f contains |to . coat| / |to . n|, because the coat's normal is not the surface's.
        const double fresnel = fresnelDielectric(double(cosine), 1.5);
        EXPECT_NEAR(d.f.r, fresnel * double(cosine / dot(mirrored, n)), 1e-3 * double(d.f.r));
        EXPECT_EQ(bsdf.evaluate(e, n * (2 * dot(e, n)) - e, ScatterEvent::DeltaReflection).f,
                  Rgb(0.0f));
        const Vec3 l = world().toWorld(polar(20, 200));
        const double left = 1 - std::max(fresnelDielectric(double(cosine), 1.5),
                                         fresnelDielectric(double(dot(l, coat)), 1.5));
        EXPECT_NEAR(bsdf.evaluate(e, l).f.r, 0.5 / kPiD * left, 1e-4);
    }
}

TEST(BsdfReference, CoatOverDiffuse) {
    // A smooth coat: rho/pi (1 - F)(1 - F)/(1 - F_avg), and everything is reflected where rho is 1.
    Random random(23);
    for (const double specular : {0.5, 1.0}) {
        Bsdf::Parameters p = makeParameters(Rgb(1.0f), 0, 0, float(specular));
        p.roughness = 0;
        const Bsdf bsdf(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, AlbedoTables());
        double average = 0;
        for (int i = 0; i < 20000; ++i) {
            const double mu = (i + 0.5) / 20000;
            average += 2 * mu * textbookFresnel(mu, 1.5) / 20000;
        }
        for (int i = 0; i < 1000; ++i) {
            Vec3d e = randomDirection(random), l = randomDirection(random);
            e.z = std::abs(e.z) + 1e-3;
            l.z = std::abs(l.z) + 1e-3;
            e = normalize(e);
            l = normalize(l);
            const double expected = (1 - specular * textbookFresnel(e.z, 1.5)) *
                                    (1 - specular * textbookFresnel(l.z, 1.5)) /
                                    (1 - specular * average) / kPiD;
            EXPECT_NEAR(double(bsdf.evaluate(Vec3(e), Vec3(l)).f.g), expected, 1e-5);
        }
    }
}

// A smooth clearcoat on a mirror: both reflect in one direction, with F of the coat and (1 - F) of the mirror. A rough
// one adds its lobe to what it leaves of the lobes under it.
TEST(BsdfReference, ClearcoatOverMirrorAndMetal) {
    Random random(27);
    for (const double weight : {0.5, 1.0}) {
        Bsdf::Parameters p =
            clearcoated(makeParameters(Rgb(0.9f, 0.5f, 0), 1, 0), float(weight), 0);
        p.roughness = 0;
        const Bsdf mirror(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
        EXPECT_FALSE(mirror.connectable());
        p.roughness = 1;
        p.clearcoatRoughness = 0.6f;
        const Bsdf rough(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
        p.clearcoat = 0;
        const Bsdf bare(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
        const double alpha = 0.36;
        const auto albedo = [&](double mu) {
            return weight *
                   double(clearcoatTable().directional(AlbedoTable::positionOf(0.36f), float(mu)));
        };
        for (int i = 0; i < 1000; ++i) {
            const Vec3d e = randomAbove(random), l = randomAbove(random);
            const double f = weight * textbookFresnel(e.z, 1.5);
            const double schlickF = 0.5 + 0.5 * std::pow(1 - e.z, 5);
            const BsdfEvaluation m = mirror.evaluate(Vec3(e), Vec3(Vec3d{-e.x, -e.y, e.z}),
                                                     ScatterEvent::DeltaReflection);
            EXPECT_NEAR(double(m.f.g), f + (1 - f) * schlickF, 1e-4);
            EXPECT_NEAR(double(m.pdfWToLight), e.z, 1e-5);  // there is only one event
            const Vec3d h = normalize(e + l);
            const double lobe = textbookD(alpha, h.z) /
                                (1 + lambda(alpha, e.z) + lambda(alpha, l.z)) / (4 * e.z * l.z);
            const double coat = weight * textbookFresnel(dot(e, h), 1.5) * lobe;
            const double left = 1 - std::max(albedo(e.z), albedo(l.z));
            const double expected = coat + left * double(bare.evaluate(Vec3(e), Vec3(l)).f.g);
            EXPECT_NEAR(double(rough.evaluate(Vec3(e), Vec3(l)).f.g), expected, 1e-3 * expected);
        }
    }
}

// F0 has the colour, limited to 1. Towards grazing angles every coat becomes white.
TEST(BsdfReference, CoatColourFadesTowardsGrazingAngles) {
    Random random(26);
    const double ior = 1.5, f0 = 0.04;
    for (const Rgb& color : {Rgb(1, 0.5f, 0), Rgb(0.3f, 0.2f, 0.1f), Rgb(0.5f, 4, 1)}) {
        Bsdf::Parameters p = tinted(makeParameters(Rgb(0.0f), 0, 0, 0.8f, float(ior)), color);
        p.roughness = 0.5f;
        const Bsdf bsdf(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
        const double most = f0 * double(maxComponent(color));
        const double brightest = (1 + std::sqrt(most)) / (1 - std::sqrt(most));
        for (int i = 0; i < 2000; ++i) {
            const Vec3d e = randomAbove(random), l = randomAbove(random);
            const Vec3d h = normalize(e + l);
            const double lobe = textbookD(0.25, h.z) / (1 + lambda(0.25, e.z) + lambda(0.25, l.z)) /
                                (4 * e.z * l.z);
            const double fresnel = textbookFresnel(dot(e, h), brightest);
            const auto expected = [&](float c) {
                // A channel rises towards 1 by the same share of its way as the brightest channel does.
                const double rise = (fresnel - most) / (1 - most), own = f0 * double(c);
                return 0.8 * (own + (1 - own) * rise) * lobe;
            };
            const BsdfEvaluation v = bsdf.evaluate(Vec3(e), Vec3(l));
            ASSERT_NEAR(double(v.f.r), expected(color.r), 1e-3 * lobe * fresnel);
            ASSERT_NEAR(double(v.f.g), expected(color.g), 1e-3 * lobe * fresnel);
            ASSERT_NEAR(double(v.f.b), expected(color.b), 1e-3 * lobe * fresnel);
        }
    }
}

// White furnace: a white base reflects what the layer does not, at every roughness and angle.
TEST(BsdfReference, WhitePlasticReturnsEverything) {
    Random random(25);
    struct Layer {
        float specular, ior;
        Rgb color{1.0f};
        float clearcoat = 0;
    };
    // The test reads green, which is one of the brightest channels in every colour here.
    const double significance = sidak(1e-3, 6 * 6 * 5);
    for (const auto& [specular, ior, color, clearcoat] : {Layer{1.0f, 1.5f},
                                                          {0.5f, 1.8f},
                                                          {1.0f, 1.33f},
                                                          {0.7f, 1.5f, {0.5f, 3, 1}},
                                                          {0, 1.5f, Rgb(1.0f), 1},
                                                          {0, 1.5f, Rgb(1.0f), 0.6f}}) {
        for (const float roughness : kRoughness) {
            for (const double degrees : kDegrees) {
                Bsdf::Parameters p = makeParameters(Rgb(1.0f), 0, 0, specular, ior);
                p.roughness = roughness;
                p.specularColor = color;
                p.clearcoat = clearcoat;
                p.clearcoatRoughness = roughness;
                const Bsdf bsdf(p, world().n, world().n, tables());
                const Vec3 from = world().toWorld(polar(degrees, 300));
                const Moments albedo = albedoSeenFrom(bsdf, from, 20000, random);
                const double excess =
                    std::max(0.0, std::abs(albedo.mean() - 1) - double(kTableError));
                EXPECT_GT(normalTail(excess / std::max(1e-9, albedo.standardError()), 2),
                          significance)
                    << specular << " " << roughness << " " << degrees << ": " << albedo.mean()
                    << " +- " << albedo.standardError();
            }
        }
    }
}

// The estimate for Russian roulette is an upper bound of the mean albedo over directions.
TEST(BsdfReference, SurvivalAlbedoBoundsTheMeanAlbedo) {
    Random random(24);
    for (const Material& m : materials()) {
        for (const float roughness : kRoughness) {
            Bsdf::Parameters p = m.parameters;
            p.roughness = roughness;
            const Bsdf bsdf(p, world().n, world().n, tables());
            Moments albedo;
            for (int i = 0; i < 4000; ++i) {
                const float a = random.next(), b = random.next(), u0 = random.next();
                const float u1 = random.next(), u2 = random.next();
                const Vec3 from = world().toWorld(cosineHemisphere(a, b));
                const auto s = bsdf.sample(Side::Light, from, u0, u1, u2);
                albedo.add(s ? double(maxComponent(s->evaluation.f)) *
                                   std::abs(double(dot(s->to, world().n))) /
                                   double(s->evaluation.pdfWToEye)
                             : 0.0);
            }
            EXPECT_LE(albedo.mean() - 4 * albedo.standardError() - 0.01,
                      double(bsdf.survivalAlbedo()))
                << m.name << " " << roughness;
        }
    }
}

/// Expects two materials to be the same.
void expectSame(const Bsdf::Parameters& a, const Bsdf::Parameters& b, const std::string& what) {
    SCOPED_TRACE(what);
    const Bsdf x(a, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
    const Bsdf y(b, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
    EXPECT_EQ(x.connectable(), y.connectable());
    EXPECT_EQ(x.isBlack(), y.isBlack());
    Random random(31);
    for (int i = 0; i < 500; ++i) {
        const Vec3 e(randomDirection(random)), l(randomDirection(random));
        const BsdfEvaluation p = x.evaluate(e, l), q = y.evaluate(e, l);
        ASSERT_EQ(p.f, q.f);
        ASSERT_EQ(p.pdfWToEye, q.pdfWToEye);
        ASSERT_EQ(p.pdfWToLight, q.pdfWToLight);
        const float u = random.next(), u1 = random.next(), u2 = random.next();
        const auto s = x.sample(Side::Eye, e, u, u1, u2), t = y.sample(Side::Eye, e, u, u1, u2);
        ASSERT_EQ(s.has_value(), t.has_value());
        if (!s) continue;
        ASSERT_FALSE(x.isBlack());
        ASSERT_EQ(s->to, t->to);
        ASSERT_EQ(s->event, t->event);
        ASSERT_EQ(s->evaluation.f, t->evaluation.f);
    }
}

TEST(BsdfReference, LobesLeftOutAreNotThere) {
    using Parameters = Bsdf::Parameters;
    const auto without = [](Parameters p, LobeKind kind) {
        p.without.add(kind);
        return p;
    };
    const Rgb red(0.9f, 0.3f, 0.1f);
    Parameters plastic = makeParameters(red, 0, 0);
    plastic.roughness = 0.5f;
    Parameters lambert = plastic;
    lambert.specular = 0.0f;
    expectSame(without(plastic, LobeKind::Glossy), lambert, "plastic without its coat");
    expectSame(without(plastic, LobeKind::Mirror), plastic, "rough plastic without mirrors");
    Parameters coat = plastic;
    coat.baseColor = Rgb(0.0f);
    expectSame(without(plastic, LobeKind::Diffuse), coat, "plastic without its base");
    plastic.roughness = lambert.roughness = 0.0f;
    expectSame(without(plastic, LobeKind::Mirror), lambert, "smooth plastic without its coat");

    Parameters clear = clearcoated(plastic, 1, 0.4f);
    expectSame(without(clear, LobeKind::Glossy), plastic, "plastic without its rough clearcoat");
    clear.clearcoatRoughness = 0.0f;
    expectSame(without(clear, LobeKind::Mirror), lambert, "without both smooth layers");

    const Parameters black = makeParameters(Rgb(0.0f), 0, 0, 0);
    for (const bool thin : {false, true}) {
        for (const float roughness : {0.0f, 0.5f}) {
            Parameters glass = makeParameters(red, 0, 1, 1, 1.5f, thin);
            glass.roughness = roughness;
            const LobeKind kind = roughness > 0.0f ? thin ? LobeKind::RoughThinTransmission
                                                          : LobeKind::RoughRefraction
                                  : thin           ? LobeKind::SmoothThinTransmission
                                                   : LobeKind::SmoothRefraction;
            expectSame(without(glass, kind), black, "no glass");
        }
    }
    Parameters metal = makeParameters(red, 1, 0);
    metal.roughness = 0.3f;
    expectSame(without(metal, LobeKind::Glossy), black, "no metal");
}

TEST(BsdfReference, WhatIsLeftOfAMixtureIsItsOtherPart) {
    // Half plastic, half metal: the metal's share is absorbed, and the plastic keeps its own.
    Bsdf::Parameters mixed = makeParameters(Rgb(0.8f, 0.4f, 0.2f), 0.5f, 0, 0);
    mixed.roughness = 0.5f;
    mixed.without.add(LobeKind::Glossy);
    const Bsdf half(mixed, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
    Random random(32);
    for (int i = 0; i < 200; ++i) {
        const BsdfEvaluation e =
            half.evaluate(Vec3(randomAbove(random)), Vec3(randomAbove(random)));
        EXPECT_NEAR(e.f.r, 0.5 * 0.8 / std::numbers::pi, 1e-6);
        EXPECT_NEAR(e.f.b, 0.5 * 0.2 / std::numbers::pi, 1e-6);
    }
    // Coat, base and glass without the base: sampling chooses only from the lobes that are left.
    Bsdf::Parameters all = makeParameters(Rgb(0.8f), 0, 0.5f);
    all.roughness = 0.5f;
    all.without.add(LobeKind::Diffuse);
    const Bsdf shiny(all, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables());
    for (int i = 0; i < 2000; ++i) {
        const auto s = shiny.sample(Side::Eye, Vec3(randomAbove(random)), random.next(),
                                    random.next(), random.next());
        if (!s) continue;
        EXPECT_GT(maxComponent(s->evaluation.f), 0.0f);
    }
}

}  // namespace
}  // namespace lacuna::test
