// Lights that are picked by what a point gets from them: a light that is never picked sends nothing, and pmfs match the
// picks. False alarms: 1e-3 over all comparisons of this file.
#include "libcore/scene/lamp_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "libcore/scene/environment.h"
#include "libcore/scene/light.h"
#include "tests/base/chi_square.h"
#include "tests/material/statistics.h"
#include "tests/scene/emissive_ball.h"
#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

constexpr double kTreeSignificance = 1e-3 / 64;  // Sidak of fewer than 64 comparisons

class SomeLights {
  public:
    explicit SomeLights(std::uint64_t seed) : rng_(seed, 0, StreamKind::User, 0) {}

    float between(float a, float b) { return a + (b - a) * rng_.uniform(); }
    Vec3 point() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
    Vec3 direction() { return normalize(point()); }
    Viewpoint viewpoint(bool oneSide) { return {point(), oneSide ? direction() : Vec3{}}; }
    Rng& rng() { return rng_; }

    void addTriangles(int count, bool twoSided, float size = 0.1f) {
        for (int i = 0; i < count; ++i) {
            EmissiveTriangle t;
            const Vec3 p = point();
            t.corners = {p, p + direction() * size, p + direction() * size};
            t.radiance = Rgb(between(0.1f, 10.0f));
            t.twoSided = twoSided;
            triangles.push_back(t);
        }
    }
    /// Flat lamps of two triangles each, one of which may be brighter.
    void addQuads(int count) {
        for (int i = 0; i < count; ++i) {
            addTriangles(1, i % 2 == 0);
            EmissiveTriangle other = triangles.back();
            const auto& [a, b, c] = triangles.back().corners;
            other.corners = {c, b, b + c - a};
            other.radiance *= 1.0f + float(i % 3);
            triangles.push_back(other);
        }
    }
    void addPunctual() {
        for (int i = 0; i < 5; ++i) {
            punctual.push_back(pointLight(Vec3d(point()), Rgb(between(0.1f, 1))));
            const double outer = 0.01 + 1.5 * double(rng_.uniform());
            punctual.push_back(spotLight(Vec3d(point()), Vec3d(direction()), Rgb(between(0.1f, 1)),
                                         0.5 * outer, outer));
        }
    }
    void addDistant() {
        Image image(4, 2);
        for (Rgb& c : image.pixels) c = Rgb(between(0, 0.2f));
        sky_ = std::make_unique<Environment>(image, 1.0, 0.0, "sky");
        punctual.push_back(directionalLight(Vec3d(direction()), Rgb(0.3f)));
        punctual.push_back(directionalLight(Vec3d(direction()), Rgb(0.2f)));
        // A sun with an extent: directional lights around one direction, which the tree treats as one.
        const Vec3 middle = direction();
        for (int i = 0; i < 20; ++i) {
            punctual.push_back(directionalLight(Vec3d(normalize(middle + direction() * 0.1f)),
                                                Rgb(between(0.001f, 0.02f))));
        }
    }
    Lights lights() const { return Lights(triangles, punctual, {}, sky_.get(), 2.0f); }

    std::vector<EmissiveTriangle> triangles;
    std::vector<PunctualLight> punctual;

  private:
    Rng rng_;
    std::unique_ptr<Environment> sky_;
};

/// Lights of all kinds: one- and two-sided surfaces, large and small, punctual lights, lights at infinity.
SomeLights allKinds(std::uint64_t seed) {
    SomeLights lamps(seed);
    lamps.addTriangles(40, false);
    lamps.addTriangles(20, true);
    lamps.addTriangles(3, false, 1.5f);
    lamps.addQuads(10);
    lamps.addPunctual();
    lamps.addDistant();
    return lamps;
}

/// Share of next event's points that lie on this light. In a sky, they follow the part above its mean.
double shareOf(const Lights& lights, std::uint32_t l, const Viewpoint& from) {
    if (l != lights.environmentIndex()) return lights.seenSamples({l}, from) * lights.pmf(l);
    const Environment& sky = *lights.environment();
    if (sky.contrast() == 0.0) return lights.seenSamples({l, {0, 1, 0}}, from) * lights.pmf(l);
    const Vec3 drawn = sky.sample(0.5, 0.5f, 0.5f, Environment::SkyPart::AboveMean).direction;
    return lights.seenSamples({l, drawn}, from) / sky.aboveMean(drawn) * lights.pmf(l);
}

TEST(LampTree, whatIsNeverPickedSendsNothing) {
    SomeLights lamps = allKinds(11);
    const Lights lights = lamps.lights();
    int sends = 0, dark = 0;
    for (int n = 0; n < 40000; ++n) {
        const Viewpoint from = lamps.viewpoint(n % 4 != 0);
        const LightPoint y = lights.samplePoint(lamps.rng());
        const bool infinite = isInfinite(y.kind);
        const Vec3 to = infinite ? y.position : normalize(y.position - from.position);
        const bool scatters = from.side == Vec3{} || dot(from.side, to) > 0.0f;
        const double pmf = lights.tree().pmf(from, y.light);
        if (scatters && lights.emission(y, -to, {}).profile > 0.0f) {
            ++sends;
            EXPECT_GT(pmf, 0.0) << "light " << y.light << ", kind " << int(y.kind);
            EXPECT_GT(lights.tree().importance(from, y.light), 0.0);
        } else {
            dark += pmf == 0.0;
        }
    }
    EXPECT_GT(sends, 5000);
    EXPECT_GT(dark, 5000) << "the cones tell nothing";
}

TEST(LampTree, probabilitiesSumToOneWhereverOneStands) {
    for (const std::uint64_t seed : {12u, 13u, 14u}) {
        SomeLights lamps = allKinds(seed);
        const Lights lights = lamps.lights();
        for (int n = 0; n < 500; ++n) {
            Viewpoint from = lamps.viewpoint(n % 2 == 0);
            if (n % 5 == 0) from.position = lights.samplePoint(lamps.rng()).position;  // on one
            if (n % 7 == 0) from.position = from.position * 1e6f;
            double byTree = 0, all = 0;
            for (std::uint32_t l = 0; l < lights.size(); ++l) {
                byTree += lights.tree().pmf(from, l);
                all += shareOf(lights, l, from);
                if (lights.pmf(l) > 0.0 && l != lights.environmentIndex()) {
                    EXPECT_GE(lights.seenSamples({l}, from), Lights::kByPower);
                }
            }
            EXPECT_NEAR(byTree, 1.0, 1e-12);
            EXPECT_NEAR(all, 1.0, 1e-12);
        }
    }
}

TEST(LampTree, whatIsAskedForIsWhatThePickHad) {
    SomeLights lamps = allKinds(15);
    const Lights lights = lamps.lights();
    for (int n = 0; n < 20000; ++n) {
        const Viewpoint from = lamps.viewpoint(n % 2 == 0);
        const LampTree::Pick pick = lights.tree().pick(from, lamps.rng().uniformDouble());
        EXPECT_EQ(pick.pmf, lights.tree().pmf(from, pick.light));
        EXPECT_GT(pick.pmf, 0.0);
        EXPECT_TRUE(pick.remapped >= 0.0 && pick.remapped < 1.0);
        const Lights::SeenPoint seen = lights.sampleSeenPoint(from, lamps.rng());
        EXPECT_EQ(seen.samples, lights.seenSamples(seen.point, from));
    }
}

TEST(LampTree, picksComeAsOftenAsTheirProbabilitySays) {
    SomeLights lamps = allKinds(16);
    const Lights lights = lamps.lights();
    constexpr std::uint64_t kDraws = 100'000;
    for (int n = 0; n < 12; ++n) {
        const Viewpoint from = lamps.viewpoint(n % 2 == 0);
        std::vector<std::uint64_t> counts(lights.size()), ofTree(lights.size()), rests(16);
        std::vector<double> pmf, pmfOfTree;
        for (std::uint32_t l = 0; l < lights.size(); ++l) {
            pmf.push_back(shareOf(lights, l, from));
            pmfOfTree.push_back(lights.tree().pmf(from, l));
        }
        for (std::uint64_t i = 0; i < kDraws; ++i) {
            ++counts[lights.sampleSeenPoint(from, lamps.rng()).point.light];
            const auto pick = lights.tree().pick(from, lamps.rng().uniformDouble());
            ++ofTree[pick.light];
            ++rests[std::size_t(pick.remapped * 16)];
        }
        EXPECT_GT(chiSquareSignificance(counts, pmf, kDraws), kTreeSignificance);
        EXPECT_GT(chiSquareSignificance(ofTree, pmfOfTree, kDraws), kTreeSignificance);
        const std::vector<double> even(16, 1.0 / 16);
        EXPECT_GT(chiSquareSignificance(rests, even, kDraws), kTreeSignificance);
    }
}

TEST(LampTree, nearLampsComeFirst) {
    SomeLights lamps(17);
    for (int i = 0; i < 1000; ++i) {
        lamps.punctual.push_back(pointLight({double(i), 0, 0}, Rgb(1.0f)));
    }
    const Lights lights(lamps.triangles, lamps.punctual, {}, nullptr, 1000.0f);
    const Viewpoint from{{500.0f, 0.5f, 0.0f}, {0, -1, 0}};
    double near = 0.0;
    for (std::uint32_t l = 495; l <= 505; ++l) near += shareOf(lights, l, from);
    EXPECT_GT(near, 0.7) << "by power 0.011";
}

// With perfect picks, what a triangle sends over its probability would be the same for all. Bounds in place of means
// give .48. One triangle is missing, so that the tree does not sample a ball.
TEST(LampTree, trianglesOfABallArePickedByWhatTheySend) {
    std::vector<EmissiveTriangle> ball = emissiveBall({}, 0.1f, 12);
    ball.pop_back();
    std::erase_if(ball, [](const EmissiveTriangle& t) {  // at the poles: they face anywhere
        return length(cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0])) < 1e-6f;
    });
    const Lights lights(ball, {}, {}, nullptr, 2.0f);
    const Viewpoint from{{0.7f, -1.2f, 0.4f}, normalize(Vec3{-0.3f, 1.0f, 0.1f})};
    double sum = 0.0, squares = 0.0;
    for (std::uint32_t l = 0; l < lights.size(); ++l) {
        const auto& [a, b, c] = lights.corners(l);
        const Vec3 middle = (a + b + c) * (1.0f / 3.0f), to = middle - from.position;
        const Vec3 normal = cross(b - a, c - a), direction = normalize(to);
        const double sent = std::max(0.0, double(-dot(normal, direction))) *
                            std::max(0.0, double(dot(from.side, direction))) / double(dot(to, to));
        const double pmf = lights.tree().pmf(from, l);
        if (sent == 0.0) continue;
        ASSERT_GT(pmf, 0.0);
        sum += sent;
        squares += sent * sent / pmf;
    }
    EXPECT_LT(squares / (sum * sum) - 1.0, 0.2);
}

// Suns around one direction are picked by power if all of them are above the side. If only some are, each still has a
// probability.
TEST(LampTree, sunsAboutOneDirectionArePickedByWhatTheySend) {
    std::vector<PunctualLight> suns;
    for (int i = 0; i < 64; ++i) {
        const double turn = 2.4 * i, off = 0.01 * std::sqrt(double(i));
        suns.push_back(directionalLight({off * std::cos(turn), -1.0, off * std::sin(turn)},
                                        Rgb(0.5f + 0.01f * float(i))));
    }
    const Lights lights({}, suns, {}, nullptr, 1.0f);
    const Viewpoint high{{}, normalize(Vec3{0.5f, 1.0f, -0.2f})};
    for (std::uint32_t l = 0; l < lights.size(); ++l) {
        EXPECT_NEAR(lights.tree().pmf(high, l), lights.pmf(l), 1e-6);
    }
    const Viewpoint grazing{{}, normalize(Vec3{1.0f, -0.075f, 0.0f})};
    for (std::uint32_t l = 0; l < lights.size(); ++l) {
        EXPECT_GT(lights.tree().pmf(grazing, l), 0.0);
    }
}

// Walks that are continued by the BSDF find an even sky as well as next event does.
TEST(LampTree, anEvenSkyLeavesTheChoiceToTheSun) {
    const auto shareOfSky = [](float sunOfSky) {
        Image image(64, 32);
        for (Rgb& c : image.pixels) c = Rgb(1.0f / kPi);
        image.at(32, 8) = Rgb(sunOfSky);
        const Environment sky(image, 1.0, 0.0, "sky");
        const PunctualLight sun = directionalLight({0, -1, 0}, Rgb(1.0f));
        const Lights lights({}, {&sun, 1}, {}, &sky, 1.0f);
        const Viewpoint from{{}, {0, 1, 0}};
        return shareOf(lights, lights.environmentIndex(), from);
    };
    EXPECT_EQ(shareOfSky(1.0f / kPi), 0.0);
    EXPECT_GT(shareOfSky(1000.0f), 0.4) << "of which hits find next to nothing";
}

// A sky with a low sun, and a lamp above. Walls that face the sun get their light from the sky, and the floor from the
// lamp.
TEST(LampTree, aSkyIsPickedByWhatASideGetsOfIt) {
    Image image(64, 32, Rgb(1e-3f));
    image.at(48, 15) = Rgb(100.0f);
    const Environment sky(image, 1.0, 0.0, "sky");
    const double power = double(mean(sky.integral())) * sky.contrast();
    const PunctualLight sun = directionalLight({0, -1, 0}, Rgb(float(power)));
    const Lights lights({}, {&sun, 1}, {}, &sky, 1.0f);
    const Vec3 toSun = sky.sample(0.5, 0.5f, 0.5f, Environment::SkyPart::AboveMean).direction;
    const auto share = [&](const Vec3& side) {
        return lights.tree().pmf({{}, normalize(side)}, lights.environmentIndex());
    };
    EXPECT_GT(share(toSun), 0.9);
    EXPECT_LT(share({0, 1, 0}), 0.2);
    EXPECT_NEAR(share(toSun + Vec3{0, 1, 0}), 0.5, 0.05);
}

// Without hits, next event draws the whole sky. Otherwise it draws only the part above the mean, and an even sky has
// none.
TEST(LampTree, ofASkyThatIsAloneIsDrawnWhatHitsDoNotFind) {
    const Environment even(Image(4, 2, Rgb(1.0f)), 1.0, 0.0, "even");
    const Lights lights({}, {}, {}, &even, 1.0f), all = lights.withoutHits();
    const Viewpoint from{{}, {0, 1, 0}};
    Rng rng(23, 0, StreamKind::User, 0);
    for (int n = 0; n < 100; ++n) {
        EXPECT_EQ(lights.sampleSeenPoint(from, rng).samples, 0.0);
        const Lights::SeenPoint seen = all.sampleSeenPoint(from, rng);
        EXPECT_EQ(seen.samples, 1.0);
        EXPECT_EQ(all.seenSamples(seen.point, from), 1.0);
        EXPECT_EQ(lights.seenSamples(seen.point, from), 0.0);
    }
}

// A point of next event over its samples has the expectation of light walks' points, wherever it has samples. Compares
// means of functions of the sky's direction. False alarms: 12 comparisons at 5 errors, 7e-6.
TEST(LampTree, pointsInASkyCountAsTheyAreDrawn) {
    for (const std::uint64_t seed : {24u, 25u}) {
        SomeLights lamps = allKinds(seed);
        const Lights lights = lamps.lights();
        const std::uint32_t sky = lights.environmentIndex();
        const Viewpoint from = lamps.viewpoint(true);
        Moments drawn[6], expected[6];
        int above = 0;
        for (int n = 0; n < 200'000; ++n) {
            const auto add = [&](Moments* moments, const LightPoint& y, double samples) {
                const Vec3 d = y.position;
                const float values[] = {1.0f, d.x, d.y, d.z, d.x * d.y, d.x * d.z};
                const double w = y.light == sky && samples > 0.0 ? 1.0 / samples : 0.0;
                for (int k = 0; k < 6; ++k) moments[k].add(w * double(values[k]));
            };
            const Lights::SeenPoint seen = lights.sampleSeenPoint(from, lamps.rng());
            add(drawn, seen.point, seen.samples);
            const LightPoint y = lights.samplePoint(lamps.rng());
            const bool isDrawn = y.light == sky && lights.seenSamples(y, from) > 0.0;
            add(expected, y, isDrawn ? 1.0 : 0.0);
            above += isDrawn;
        }
        EXPECT_GT(above, 1000);
        for (int k = 0; k < 6; ++k) {
            EXPECT_LT(std::fabs(drawn[k].mean() - expected[k].mean()),
                      5 * std::hypot(drawn[k].standardError(), expected[k].standardError()))
                << k;
        }
    }
}

TEST(LampTree, oneLightOrNoneIsNoChoice) {
    SomeLights none(18);
    EXPECT_TRUE(none.lights().empty());
    EXPECT_FALSE(none.lights().tree().chooses());

    SomeLights one(19);
    one.addTriangles(1, false);
    EmissiveTriangle dark = one.triangles[0];
    dark.radiance = {};
    EmissiveTriangle flat = one.triangles[0];
    flat.corners[2] = flat.corners[1];
    one.triangles.insert(one.triangles.begin(), {dark, flat});
    const Lights lights = one.lights();
    const Viewpoint from = one.viewpoint(true);
    for (std::uint64_t n = 0; n < 100; ++n) {
        Rng a(1, 0, StreamKind::User, n), b = a;
        const LightPoint p = lights.samplePoint(a);
        const Lights::SeenPoint seen = lights.sampleSeenPoint(from, b);
        EXPECT_EQ(seen.point.light, 2u);
        EXPECT_EQ(seen.point.position, p.position);
        EXPECT_EQ(seen.samples, 1.0);
        EXPECT_EQ(a.bits(), b.bits());
    }
    for (const std::uint32_t l : {0u, 1u}) EXPECT_EQ(lights.seenSamples({l}, from), 0.0);
    EXPECT_EQ(lights.seenSamples({2}, from), 1.0);

    SomeLights quad(22);
    quad.addQuads(1);
    EXPECT_FALSE(quad.lights().tree().chooses()) << "two halves are one lamp";
}

TEST(LampTree, lightsInOnePlaceAndWithoutPowerDoNoHarm) {
    SomeLights lamps(20);
    lamps.addTriangles(1, false);
    for (int i = 0; i < 100; ++i) lamps.triangles.push_back(lamps.triangles[0]);
    for (std::size_t i = 0; i < 100; i += 3) lamps.triangles[i].radiance = {};
    for (std::size_t i = 1; i < 100; i += 3) {
        lamps.triangles[i].corners[1] = lamps.triangles[i].corners[0];  // no area
    }
    for (int i = 0; i < 10; ++i) {
        lamps.punctual.push_back(pointLight({0.5, 0.5, 0.5}, Rgb(i % 2 ? 1.0f : 1e-30f)));
    }
    const Lights lights = lamps.lights();
    for (int n = 0; n < 200; ++n) {
        Viewpoint from = lamps.viewpoint(true);
        if (n % 4 == 0) from.position = {0.5f, 0.5f, 0.5f};
        double sum = 0;
        for (std::uint32_t l = 0; l < lights.size(); ++l) {
            const double samples = lights.seenSamples({l}, from);
            ASSERT_TRUE(std::isfinite(samples));
            sum += samples * lights.pmf(l);
        }
        EXPECT_NEAR(sum, 1.0, 1e-12);
        const Lights::SeenPoint seen = lights.sampleSeenPoint(from, lamps.rng());
        EXPECT_GT(lights.pmf(seen.point.light), 0.0);
    }
}

TEST(LampTree, powersOfTwoInSizeChangeNoBit) {
    SomeLights lamps = allKinds(21);
    for (const float scale : {0x1p-20f, 0x1p30f}) {
        SomeLights other = allKinds(21);
        for (EmissiveTriangle& t : other.triangles) {
            for (Vec3& c : t.corners) c = c * scale;
            t.radiance *= 1.0f / scale / scale;
        }
        for (PunctualLight& l : other.punctual) {
            l.position = l.position * double(scale);
            // Distant lights shine on an area, so their power grows with it.
            if (l.kind == PunctualLight::Kind::Directional) l.intensity *= 1.0f / scale / scale;
        }
        const Lights scaled(other.triangles, other.punctual, {}, nullptr, 2.0f * scale);
        const Lights same(lamps.triangles, lamps.punctual, {}, nullptr, 2.0f);
        for (int n = 0; n < 200; ++n) {
            const Viewpoint from = lamps.viewpoint(n % 2 == 0);
            for (std::uint32_t l = 0; l < same.size(); ++l) {
                EXPECT_EQ(same.tree().pmf(from, l),
                          scaled.tree().pmf({from.position * scale, from.side}, l));
            }
        }
    }
}

}  // namespace
}  // namespace lacuna::test
