// Identities that hold exactly, or up to rounding, for every pair of directions (numerics.md, "BSDFs").
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/material/materials.h"
#include "tests/material/statistics.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

void expectClose(float a, float b, float relative, const char* what) {
    EXPECT_LE(std::abs(a - b), relative * std::max(std::abs(a), std::abs(b)))
        << what << a << " " << b;
}

Vec3 uniformDirection(Random& random) {
    const double z = 2 * random.real() - 1, phi = 2 * std::numbers::pi * random.real();
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return Vec3(Vec3d{r * std::cos(phi), r * std::sin(phi), z});
}

TEST(BsdfContract, SampleEvaluationIsEvaluateBitForBit) {
    Random random(11);
    int drawn = 0;
    for (const Case& c : grid()) {
        for (int i = 0; i < 20; ++i) {
            const float u0 = random.next(), u1 = random.next(), u2 = random.next();
            const auto s = c.bsdf.sample(c.side, c.from, u0, u1, u2);
            if (!s) {
                continue;
            }
            ++drawn;
            const BsdfEvaluation e = c.evaluate(s->to, s->event);
            ASSERT_EQ(e.f, s->evaluation.f) << c.name;
            ASSERT_EQ(e.pdfWToLight, s->evaluation.pdfWToLight) << c.name;
            ASSERT_EQ(e.pdfWToEye, s->evaluation.pdfWToEye) << c.name;
            ASSERT_NEAR(length(s->to), 1, 1e-6) << c.name;
            ASSERT_GE(std::abs(dot(s->to, c.bsdf.ng())), kMinCosine);
        }
    }
    EXPECT_GT(drawn, 50000);
    stabilityCase("bsdf-contract", drawn, "samples, each as evaluated");
}

// f is the sum of the diffuse part and of what a Bsdf without diffuse lobes scatters.
TEST(BsdfContract, DiffusePartIsWhatIsMissingWithoutTheBase) {
    Random random(13);
    int mixed = 0;
    for (const Case& c : grid()) {
        Bsdf::Parameters p = c.parameters;
        // Leaving out a sheen brightens the layers under it, so the sum would be larger.
        if (!isBlack(p.sheenColor)) continue;
        p.without.add(LobeKind::Diffuse);
        p.without.add(LobeKind::DiffuseTransmission);
        const Bsdf rest(p, c.bsdf.ng(), c.bsdf.ns(), tables());
        for (int i = 0; i < 10; ++i) {
            const Vec3 to = uniformDirection(random);
            const Vec3 &toEye = c.side == Side::Eye ? c.from : to,
                       &toLight = c.side == Side::Eye ? to : c.from;
            const Rgb all = c.bsdf.evaluate(toEye, toLight).f;
            const Rgb base = c.bsdf.diffusePart(toEye, toLight);
            const Rgb glossy = rest.evaluate(toEye, toLight).f;
            ASSERT_LE(std::abs(base.r + glossy.r - all.r), 2e-5f * all.r) << c.name;
            ASSERT_LE(std::abs(base.b + glossy.b - all.b), 2e-5f * all.b) << c.name;
            const bool through = (dot(to, c.bsdf.ng()) > 0) != (dot(c.from, c.bsdf.ng()) > 0);
            const Bsdf& b = c.bsdf;
            ASSERT_TRUE((through ? b.transmitsDiffusely() : b.isDiffuse()) || base == Rgb{})
                << c.name;
            ASSERT_TRUE((through ? b.transmitsGlossily() : b.isGlossy()) || glossy == Rgb{})
                << c.name;
            ASSERT_TRUE(!through || b.transmits() || all == Rgb{}) << c.name;
            mixed += base.r > 0.0f && glossy.r > 0.0f ? 1 : 0;
        }
    }
    EXPECT_GT(mixed, 3000);
}

// Where ns = ng, f / eta_eye^2 is symmetric. A density is the same number whichever role its direction plays.
TEST(BsdfContract, ReciprocityAndSwappedRoles) {
    Random random(12);
    int compared = 0;
    for (const Case& c : grid()) {
        if (c.tilted) continue;
        for (int i = 0; i < 20; ++i) {
            const float u0 = random.next(), u1 = random.next(), u2 = random.next();
            const auto s = c.bsdf.sample(c.side, c.from, u0, u1, u2);
            const Vec3 a = c.from;
            const Vec3 b = s ? s->to : uniformDirection(random);
            const ScatterEvent event = s ? s->event : ScatterEvent::Smooth;
            const BsdfEvaluation ab = c.bsdf.evaluate(a, b, event);
            const BsdfEvaluation ba = c.bsdf.evaluate(b, a, event);
            SCOPED_TRACE(c.name);
            // A delta event evaluates Fresnel at toEye's cosine, which differs from toLight's by rounding.
            const float tolerance =
                isDelta(event) ? 1e-4f / std::min(1.0f, 100 * std::abs(dot(a, c.bsdf.ns())))
                               : 2e-6f;
            expectClose(ab.pdfWToLight, ba.pdfWToEye, tolerance, "pdf a -> b ");
            expectClose(ab.pdfWToEye, ba.pdfWToLight, tolerance, "pdf b -> a ");
            const auto symmetric = [&](const BsdfEvaluation& e, Vec3 toEye, Vec3 toLight) {
                const bool transmits = dot(toEye, c.bsdf.ng()) * dot(toLight, c.bsdf.ng()) < 0;
                const float eta = transmits ? float(c.indexOn(dot(toEye, c.bsdf.ng()) > 0)) : 1.0f;
                return e.f.r / (eta * eta);
            };
            expectClose(symmetric(ab, a, b), symmetric(ba, b, a), tolerance + 1e-6f, "f ");
            compared += ab.pdfWToLight > 0;
        }
    }
    EXPECT_GT(compared, 25000);
    stabilityCase("bsdf-contract", compared, "pairs of directions, each symmetric");
}

// With tilted normals, f and the eye walk's density are mixtures of those of two untilted Bsdfs. The light walk picks
// one of the two normals with probabilities that depend on toLight alone.
TEST(BsdfContract, TiltedLobesAreAMixtureOfBothNormals) {
    Random random(17);
    int pairs[3] = {0, 0, 0};  // lobes about ns, about ng, about both
    for (const Material& m : materials()) {
        for (const float roughness : {0.1f, 0.3f, 0.6f, 1.0f}) {
            Bsdf::Parameters p = m.parameters;
            p.roughness = roughness;
            // Diffuse lobes and sheen keep ns for the light. A clearcoat with its own normal is two mixtures.
            for (const LobeKind kind :
                 {LobeKind::Diffuse, LobeKind::DiffuseTransmission, LobeKind::Sheen}) {
                p.without.add(kind);
            }
            if (lengthSquared(p.clearcoatNormal) > 0) continue;
            for (int tilt = 0; tilt < 40; ++tilt) {
                const Vec3 ng = uniformDirection(random);
                const double degrees = 80 * random.real() * random.real();
                const Vec3 ns = Frame(ng).toWorld(polar(degrees, 360 * random.real()));
                const Bsdf tilted(p, ng, ns, tables());
                const Bsdf aboutNs = tilted.at(ns, ns), aboutNg = tilted.at(ng, ng);
                const Vec3 l = uniformDirection(random);
                // Rounding changes such cosines by more than the tolerance.
                const auto isGrazing = [&](Vec3 v) {
                    return std::min(std::abs(dot(v, ng)), std::abs(dot(v, ns))) < 0.01f;
                };
                if (isGrazing(l)) continue;
                const bool seen = dot(l, ng) * dot(l, ns) > 0;
                const double adjoint = seen ? double(dot(l, ns)) / double(dot(l, ng)) : 0;
                double picked[2] = {-1, -1};  // probability of ns and of ng in the light walk
                for (int i = 0; i < 40; ++i) {
                    const Vec3 e = uniformDirection(random);
                    const double w = shareOfNg(Vec3d(e), Vec3d(ng), Vec3d(ns));
                    // Rounding may decide near w = 0 and w = 1 whether a part exists at all.
                    if ((w > 0 && w < 0.02) || (w < 1 && w > 0.98) || isGrazing(e)) continue;
                    const BsdfEvaluation all = tilted.evaluate(e, l);
                    const BsdfEvaluation s =
                        w < 1 && seen ? aboutNs.evaluate(e, l) : BsdfEvaluation{};
                    const BsdfEvaluation g = w > 0 ? aboutNg.evaluate(e, l) : BsdfEvaluation{};
                    const auto near = [&](double found, double expected, double scale) {
                        EXPECT_NEAR(found, expected, 1e-4 * scale + 1e-12)
                            << m.name << " " << roughness << " " << degrees << " " << w;
                    };
                    const double parts[2] = {(1 - w) * adjoint * double(s.f.g), w * double(g.f.g)};
                    near(double(all.f.g), parts[0] + parts[1], parts[0] + parts[1]);
                    const double pdfs[2] = {(1 - w) * double(s.pdfWToLight),
                                            w * double(g.pdfWToLight)};
                    near(double(all.pdfWToLight), pdfs[0] + pdfs[1], pdfs[0] + pdfs[1]);
                    pairs[w == 0 ? 0 : w == 1 ? 1 : 2] += all.f.g > 0;
                    if (w != 0 && w != 1) continue;
                    const double alone = double(w == 0 ? s.pdfWToEye : g.pdfWToEye);
                    if (alone < 1e-6) continue;
                    double& q = picked[w == 0 ? 0 : 1];
                    if (q >= 0) near(double(all.pdfWToEye), q * alone, q * alone);
                    q = double(all.pdfWToEye) / alone;
                }
                if (picked[0] >= 0 && picked[1] >= 0) {
                    EXPECT_NEAR(picked[0] + picked[1], 1, 1e-3);
                }
                if (picked[1] >= 0) {
                    EXPECT_GT(picked[1], 0);
                }
            }
        }
    }
    for (const int n : pairs) EXPECT_GT(n, 1000);
}

// Glass with the index of air lets light pass straight, whichever normal is used. Rounding must not choose one.
TEST(BsdfContract, GlassThatDoesNotBendHasOneEvent) {
    Bsdf::Parameters p;
    p.baseColor = Rgb(0.8f);
    p.transmission = 1.0f;
    p.ior = 1.0f;
    p.thin = false;
    p.roughness = 0.5f;
    const Vec3 ng{0, 0, 1}, ns = normalize(Vec3{0.5f, 0, 1});
    const Bsdf bsdf(p, ng, ns, tables());
    int mixed = 0;
    for (int i = 1; i < 90; ++i) {
        const Vec3 e = polar(i, 190);
        const float share = bsdf.shareAboutNg(e);
        mixed += share > 0.01f && share < 0.99f ? 1 : 0;
        const BsdfEvaluation exact = bsdf.evaluateDelta(e, -e, ScatterEvent::DeltaTransmission);
        EXPECT_NEAR(exact.f.g, 0.8f, 1e-5f) << i;
        EXPECT_NEAR(exact.pdfWToLight, std::abs(e.z), 1e-5f) << i;
        for (const Vec3& off : {Vec3{1e-6f, 0, 0}, Vec3{0, 1e-6f, 0}, Vec3{0, 0, 1e-6f}}) {
            const BsdfEvaluation rounded =
                bsdf.evaluateDelta(e, normalize(-e + off), ScatterEvent::DeltaTransmission);
            EXPECT_NEAR(rounded.f.g, exact.f.g, 1e-5f) << i;
            EXPECT_NEAR(rounded.pdfWToLight, exact.pdfWToLight, 1e-5f) << i;
            EXPECT_NEAR(rounded.pdfWToEye, exact.pdfWToEye, 1e-5f) << i;
        }
    }
    EXPECT_GT(mixed, 5);
}

// No eye above the surface sees a lit surface black, and none sees more than a white surface can reflect.
TEST(BsdfContract, TiltedNormalsLeaveNoEyeInTheDark) {
    Random random(18);
    for (const Material& m : {materials()[0], materials()[1], materials()[5]}) {
        for (const float roughness : {0.0f, 0.3f, 1.0f}) {
            Bsdf::Parameters p = m.parameters;
            p.baseColor = Rgb(1.0f);
            p.roughness = roughness;
            for (const double tilt : {5.0, 20.0, 45.0}) {
                const Vec3 ng = world().n, ns = world().toWorld(polar(tilt, 0));
                const Bsdf bsdf(p, ng, ns, tables());
                for (const double degrees : {30.0, 60.0, 80.0, 85.0, 88.0}) {
                    const Vec3 toEye = world().toWorld(polar(degrees, 180));
                    const Moments albedo = albedoSeenFrom(bsdf, toEye, 4000, random);
                    SCOPED_TRACE(m.name + " " + std::to_string(roughness) + " tilted by " +
                                 std::to_string(tilt) + ", seen at " + std::to_string(degrees));
                    EXPECT_GT(albedo.mean(), 0.3);
                    EXPECT_LT(albedo.mean(),
                              1.0 + double(kTableError) + 5 * albedo.standardError());
                }
            }
        }
    }
}

// Both walks estimate the same integral over pairs of directions (adjointness), with tilted normals and on both sides
// of glass. A step multiplies the throughput by f |to.ng| / pdfW(to).
TEST(BsdfContract, BothWalksAgree) {
    constexpr int kSamples = 50000;
    const std::vector<Material> all = materials();
    const double significance = sidak(1e-3, double(all.size() * 3));
    double worst = 0;
    for (const Material& m : all) {
        for (const float roughness : {0.0f, 0.3f, 0.8f}) {
            Bsdf::Parameters p = m.parameters;
            p.roughness = roughness;
            const Vec3 ng = world().toWorld(polar(25, 77));
            const Vec3 ns = world().n;
            const Bsdf bsdf(p, ng, ns, tables());
            Random random(13);
            Moments walk[2];
            for (int i = 0; i < kSamples; ++i) {
                for (const Side side : {Side::Eye, Side::Light}) {
                    const Vec3 from = uniformDirection(random);
                    const float u0 = random.next(), u1 = random.next(), u2 = random.next();
                    const auto s = bsdf.sample(side, from, u0, u1, u2);
                    double value = 0;
                    if (s) {
                        const Vec3 eye = side == Side::Eye ? from : s->to;
                        const Vec3 light = side == Side::Eye ? s->to : from;
                        const double pdfW = double(side == Side::Eye ? s->evaluation.pdfWToLight
                                                                     : s->evaluation.pdfWToEye);
                        // |eye.ns| keeps the adjoint factor's variance finite; the other factors are arbitrary.
                        const double test = std::abs(double(dot(eye, ns))) *
                                            (1.2 + double(dot(eye, Vec3{0.6f, 0, 0.8f}))) *
                                            (1.1 - double(dot(light, Vec3{0, 0.8f, 0.6f})));
                        value = test * double(s->evaluation.f.g) / pdfW *
                                std::abs(double(dot(eye, ng)) * double(dot(light, ng)));
                    }
                    walk[int(side)].add(value);
                }
            }
            const double error = std::hypot(walk[0].standardError(), walk[1].standardError());
            const double z = std::abs(walk[0].mean() - walk[1].mean()) / std::max(1e-12, error);
            worst = std::max(worst, z);
            EXPECT_GT(normalTail(z, 2), significance)
                << m.name << " " << roughness << ": " << walk[0].mean() << " " << walk[1].mean();
        }
    }
    stabilityCase("bsdf-contract", worst, "standard errors between the walks");
}

TEST(BsdfContract, SpecularZeroIsExactlyLambert) {
    Random random(14);
    const Rgb rho(0.8f, 0.5f, 0.25f);
    for (const float roughness : kRoughness) {
        Bsdf::Parameters p = makeParameters(rho, 0, 0, 0);
        p.roughness = roughness;
        const Bsdf bsdf(p, world().n, world().n, AlbedoTables());
        for (int i = 0; i < 1000; ++i) {
            const Vec3 e = uniformDirection(random), l = uniformDirection(random);
            const BsdfEvaluation v = bsdf.evaluate(e, l);
            const float ce = dot(e, world().n), cl = dot(l, world().n);
            if (ce * cl > 0) {
                EXPECT_EQ(v.f, rho * kInvPi);
                EXPECT_EQ(v.pdfWToLight, std::abs(cl) * kInvPi);
                EXPECT_EQ(v.pdfWToEye, std::abs(ce) * kInvPi);
            } else {
                EXPECT_EQ(v.f, Rgb(0.0f));
            }
        }
        EXPECT_FALSE(bsdf.sample(Side::Eye, world().n, 0.5f, 0.5f, 0.5f)->event !=
                     ScatterEvent::Smooth);
        EXPECT_EQ(bsdf.survivalAlbedo(), 0.8f);
    }
}

// Smooth glass loses nothing: both events together return everything. Seen from inside, radiance is n^2 times that
// outside.
TEST(BsdfContract, SmoothGlassIsLossless) {
    for (const bool thin : {false, true}) {
        for (const float ior : {1.0f, 1.1f, 1.5f, 2.4f}) {
            Bsdf::Parameters p = makeParameters(Rgb(1.0f), 0, 1, 1, ior, thin);
            p.roughness = 0;
            const Bsdf bsdf(p, world().n, world().n, tables());
            EXPECT_FALSE(bsdf.connectable());
            for (const double degrees : {0.0, 20.0, 40.0, 43.0, 60.0, 89.0, 89.9}) {
                for (const bool front : {true, false}) {
                    const Vec3 up = world().toWorld(polar(degrees, 123));
                    const Vec3 from = front ? up : -up;
                    double sum = 0, radiance = 0;
                    bool seen[3] = {false, false, false};
                    // Both outcomes of the choice once each, weighted by their probabilities.
                    for (const float u : {0.0f, 0x1.fffffep-1f}) {
                        const auto s = bsdf.sample(Side::Eye, from, u, 0.3f, 0.6f);
                        if (!s || seen[std::size_t(s->event)]) {
                            continue;
                        }
                        seen[std::size_t(s->event)] = true;
                        const bool transmits = s->event == ScatterEvent::DeltaTransmission;
                        const bool toFront = dot(s->to, world().n) > 0;
                        const double eta = transmits && !thin && !toFront ? double(ior) : 1.0;
                        const double pmf = double(s->evaluation.pdfWToLight) /
                                           (eta * eta * std::abs(double(dot(s->to, world().n))));
                        const double weight = double(s->evaluation.f.r) *
                                              std::abs(double(dot(s->to, world().n))) /
                                              double(s->evaluation.pdfWToLight);
                        const double etaEye = transmits && !thin && !front ? double(ior) : 1.0;
                        radiance += pmf * weight;
                        sum += pmf * weight * eta * eta / (etaEye * etaEye);
                    }
                    EXPECT_NEAR(sum, 1, 2e-6) << ior << " " << degrees << " " << front;
                    // Radiance 1 arrives from everywhere, also from inside (in a closed scene it would be n^2 there).
                    if (!thin && !front && degrees < 20) {
                        const double f = std::pow((ior - 1) / (ior + 1), 2);
                        EXPECT_NEAR(radiance, f + (1 - f) * ior * ior, 1e-4);
                    }
                }
            }
        }
    }
}

TEST(BsdfContract, FuzzedInputsStayFinite) {
    Random random(15);
    const auto extreme = [&](float limit) {
        const float u = random.next();
        return u < 0.2f ? 0.0f : u < 0.4f ? limit : random.next() * limit;
    };
    // Both sides, grazing angles around kMinCosine, exact tangents.
    const auto direction = [&](Vec3 n) {
        const Frame frame(n);
        const double cosine = std::exp(std::log(1e-9) * random.real()) *
                              (random.next() < 0.5f ? -1 : 1) * (random.next() < 0.05f ? 0 : 1);
        const double phi = 2 * std::numbers::pi * random.real();
        const double r = std::sqrt(std::max(0.0, 1 - cosine * cosine));
        return normalize(frame.toWorld(Vec3(Vec3d{r * std::cos(phi), r * std::sin(phi), cosine})));
    };
    const auto isSane = [](const BsdfEvaluation& e) {
        const auto sane = [](float x) { return x >= 0 && std::isfinite(x); };
        return sane(e.f.r) && sane(e.f.g) && sane(e.f.b) && sane(e.pdfWToEye) &&
               sane(e.pdfWToLight);
    };
    for (int i = 0; i < 300000; ++i) {
        Bsdf::Parameters p;
        p.baseColor = {extreme(1), extreme(1), extreme(1)};
        p.metallic = extreme(1);
        p.transmission = extreme(1);
        p.specular = random.next() < 0.1f ? 1e-30f : extreme(1);
        if (random.next() < 0.5f) {
            p.specularColor = {extreme(3), extreme(1), extreme(1e30f)};
        }
        p.thin = random.next() < 0.5f;
        if (random.next() < 0.5f) {
            p.clearcoat = random.next() < 0.1f ? 1e-30f : extreme(1);
            p.clearcoatRoughness = extreme(1);
        }
        if (random.next() < 0.3f) {
            p.anisotropy = random.next() < 0.1f ? 1e-30f : extreme(1);
            p.tangent = uniformDirection(random) * (random.next() < 0.1f ? 0.0f : 2.0f);
        }
        if (random.next() < 0.3f) {
            p.sheenColor = {extreme(1), extreme(1e-6f), extreme(1)};
            p.sheenRoughness = extreme(1);
        }
        if (random.next() < 0.3f) {
            p.diffuseTransmission = random.next() < 0.1f ? 1e-30f : extreme(1);
            p.diffuseTransmissionColor = {extreme(1), extreme(1e-6f), extreme(1)};
        }
        const float roughness[] = {0, 0.0099f, 0.01f, 0.010001f, 0.02f, random.next(), 1};
        p.roughness = roughness[std::size_t(random.next() * 7)];
        const float ior[] = {1,  1.0000001f, 1.00001f, 1.001f, 1.5f, 1 + random.next(),
                             10, 1e4f,       1e30f};
        p.ior = ior[std::size_t(random.next() * 9)];
        const Vec3 ns = uniformDirection(random);
        const Vec3 other = uniformDirection(random);
        const Vec3 ng = random.next() < 0.5f ? ns : dot(other, ns) > 0 ? other : -other;
        if (random.next() < 0.3f) {
            const Vec3 coat = uniformDirection(random);
            if (std::abs(dot(coat, ng)) > 1e-3f)
                p.clearcoatNormal = dot(coat, ng) > 0 ? coat : -coat;
        }
        const Bsdf bsdf(p, ng, ns, tables());
        const Vec3 a = direction(ns);
        const Vec3 near = normalize(ns * (2 * dot(a, ns)) - a);
        const Vec3 b[] = {direction(ns), -a, a, near, direction(ng)};
        for (const Vec3& to : b) {
            for (const ScatterEvent e : {ScatterEvent::Smooth, ScatterEvent::DeltaReflection,
                                         ScatterEvent::DeltaTransmission}) {
                ASSERT_TRUE(isSane(bsdf.evaluate(a, to, e)));
            }
        }
        const float edge = 0x1.fffffep-1f;
        const auto u = [&] {
            const float x = random.next();
            return x < 0.1f ? 0.0f : x < 0.2f ? edge : x < 0.3f ? 0.5f : random.next();
        };
        for (const Side side : {Side::Eye, Side::Light}) {
            const float u0 = u(), u1 = u(), u2 = u();
            const auto s = bsdf.sample(side, a, u0, u1, u2);
            if (s) {
                ASSERT_TRUE(isSane(s->evaluation));
                ASSERT_TRUE(isFinite(s->to));
                ASSERT_GT(side == Side::Eye ? s->evaluation.pdfWToLight : s->evaluation.pdfWToEye,
                          0);
            }
        }
        ASSERT_GT(bsdf.survivalAlbedo(), 0);
        ASSERT_LE(bsdf.survivalAlbedo(), 1);
        ASSERT_TRUE(isFinite(bsdf.layerAlbedo()));
    }
}

TEST(BsdfContract, EmptyAndBlack) {
    const Bsdf empty;
    EXPECT_TRUE(empty.isBlack());
    EXPECT_FALSE(empty.connectable());
    EXPECT_FALSE(empty.sample(Side::Eye, Vec3{0, 0, 1}, 0.5f, 0.5f, 0.5f));
    const Bsdf black(makeParameters(Rgb(0.0f), 0, 0, 0), world().n, world().n, tables());
    EXPECT_TRUE(black.isBlack());
    // A smooth coat leaves its base connectable; a mirror has no lobe to connect to.
    Bsdf::Parameters p = makeParameters(Rgb(0.5f), 0, 0);
    p.roughness = 0;
    EXPECT_TRUE(Bsdf(p, world().n, world().n, tables()).connectable());
    p.metallic = 1;
    EXPECT_FALSE(Bsdf(p, world().n, world().n, tables()).connectable());
    // With ior 1, a rough solid body lets light pass in a straight line.
    p = makeParameters(Rgb(0.5f), 0, 1, 1, 1.0f);
    p.roughness = 0.7f;
    const Vec3 from = world().toWorld(polar(70, 20));
    const auto s =
        Bsdf(p, world().n, world().n, tables()).sample(Side::Eye, from, 0.4f, 0.1f, 0.2f);
    ASSERT_TRUE(s);
    EXPECT_EQ(s->event, ScatterEvent::DeltaTransmission);
    EXPECT_LT(length(s->to + from), 1e-6f);
}

}  // namespace
}  // namespace lacuna::test
