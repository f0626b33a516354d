// Acceptance 7: strategies one by one. The unweighted image of every strategy that can make all
// paths of a length has the same mean. Scenes are open and nothing in them touches: unweighted
// connections need a geometry term that is bounded, or their variance is not finite.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

constexpr int kBatches = 40;

struct TechniqueScene {
    std::string name;
    SceneBuilder builder;
    int minEdges, maxEdges;
    /// Whether strategy (s, t) makes all paths of s + t - 1 edges that any makes.
    std::function<bool(int s, int t)> complete = [](int, int) { return true; };
    int iterations = 40;
    std::vector<std::string> settings = {};
};
void PrintTo(const TechniqueScene& s, std::ostream* out) {
    *out << s.name;
}

bool withoutHits(int s, int) {
    return s > 0;
}

/// A floor and a slanted wall that do not touch; the camera sees no light.
SceneBuilder plates(bool bent) {
    SceneBuilder b;
    Mesh floor = quad({-1.2f, 0, 1.2f}, {2.4f, 0, 0}, {0, 0, -2.4f});
    Mesh wall =
        quad({-1, 0.4f, -1.3f}, {2, 0, 0}, {0, 1.3f, -0.3f}, b.add(matte({0.7f, 0.5f, 0.4f})));
    if (bent) {
        floor.normals = {{0.3f, 1, 0.1f}, {-0.3f, 1, 0.2f}, {0.2f, 1, -0.3f}, {0, 1, 0.3f}};
        wall.normals = {{0.2f, 0, 1}, {-0.3f, 0.2f, 1}, {0, -0.3f, 1}, {0.3f, 0.3f, 1}};
    }
    b.add(floor);
    b.add(wall);
    b.add(lookAt({0.2, 1.1, 3}, {0, 0.45, 0}, 45));
    return b;
}

void addQuadLight(SceneBuilder& b) {
    b.add(quad({-0.4f, 2, 0.2f}, {0.8f, 0, 0}, {0, 0.1f, 0.7f}, b.add(emitter(Rgb(4.0f)))));
}

Texture strongBumps() {
    Texture bumps;
    bumps.width = bumps.height = 4;
    for (int i = 0; i < 16; ++i) {
        const std::uint8_t texel[] = {std::uint8_t(48 + 160 * (i % 2)),
                                      std::uint8_t(208 - 53 * (i / 4)), 220, 255};
        bumps.rgba.insert(bumps.rgba.end(), texel, texel + 4);
    }
    return bumps;
}

std::vector<TechniqueScene> techniqueScenes() {
    std::vector<TechniqueScene> scenes;
    {
        TechniqueScene s{"diffuse", plates(false), 2, 4};
        s.builder.add(sphere({0, 0.6f, 0}, 0.35f, 12, 0));
        addQuadLight(s.builder);
        scenes.push_back(s);
    }
    {
        TechniqueScene s{"shading normals", plates(true), 2, 4};
        s.builder.add(
            sphere({0, 0.6f, 0}, 0.35f, 12, s.builder.add(metal({0.9f, 0.7f, 0.5f}, 0.7f)), true));
        addQuadLight(s.builder);
        scenes.push_back(s);
    }
    {
        // Strong bumps on the floor, vertex colours on the wall, a veil between light and floor.
        TechniqueScene s{"normal map, colours and a veil", plates(false), 2, 4};
        SceneBuilder& b = s.builder;
        lacuna::Material bumpy = plastic({0.6f, 0.5f, 0.4f}, 0.7f);
        bumpy.normalTexture = b.add(strongBumps());
        b.d.meshes[0].material = b.add(bumpy);
        b.d.meshes[1].colors = {{1, 1, 1, 1}, {1, 0.2f, 0.2f, 1}, {0.1f, 1, 0.3f, 1}, {1, 1, 0, 1}};
        lacuna::Material veil = matte(Rgb(0.8f));
        veil.alphaMode = lacuna::Material::Alpha::Blend;
        veil.baseAlpha = 0.6f;
        b.add(quad({-0.8f, 0.8f, -0.6f}, {1.6f, 0, 0}, {0, 0.1f, 1.4f}, b.add(veil)));
        addQuadLight(b);
        scenes.push_back(s);
    }
    {
        // The camera looks along a floor: much of what it sees lies below the plane of the shading
        // normal, and much of what that reflects goes into the floor first.
        SceneBuilder b;
        lacuna::Material bumpy = plastic({0.6f, 0.5f, 0.4f}, 0.6f);
        bumpy.clearcoat = 0.7f;
        bumpy.clearcoatRoughness = 0.7f;
        bumpy.normalTexture = b.add(strongBumps());
        b.add(quad({-1.2f, 0, 1.2f}, {2.4f, 0, 0}, {0, 0, -2.4f}, b.add(bumpy)));
        b.add(quad({-1, 0.1f, -1.3f}, {2, 0, 0}, {0, 1.3f, 0.2f}));
        b.add(lookAt({0.2, 0.5, 3}, {0, 0.1, 0}, 30));
        addQuadLight(b);
        scenes.push_back({"grazing view of a normal map", b, 2, 4});
    }
    {
        // Two rough faces of a plate of glass between light and floor.
        TechniqueScene s{"rough refraction", plates(false), 2, 4};
        // Very rough: unweighted connections across the plate meet two lobes at once.
        const auto rough = s.builder.add(glass(1.5f, 0.95f));
        s.builder.add(quad({-0.8f, 0.9f, -0.6f}, {0, 0.1f, 1.4f}, {1.6f, 0, 0}, rough));
        s.builder.add(quad({-0.8f, 0.6f, -0.6f}, {1.6f, 0, 0}, {0, 0.1f, 1.4f}, rough));
        addQuadLight(s.builder);
        scenes.push_back(s);
    }
    {
        // Light inside smooth glass: only splats and hits make what it casts on the floor. Where one refracts
        // importance, the other refracts radiance.
        SceneBuilder b;
        b.add(quad({-1.2f, 0, 1.2f}, {2.4f, 0, 0}, {0, 0, -2.4f}));
        b.add(quad({-9, 0.9f, 9}, {0, 0, -18}, {18, 0, 0}, b.add(glass())));
        b.add(quad({-0.4f, 1.4f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}, b.add(emitter(Rgb(4.0f)))));
        b.add(lookAt({0, 0.7, 2.5}, {0, 0, 0.1}, 30));
        TechniqueScene s{"light in smooth glass", b, 3, 3};
        s.complete = [](int s_, int t) { return s_ == 0 || t == 1; };
        scenes.push_back(s);
    }
    {
        // Camera inside rough glass, floor and light outside.
        SceneBuilder b;
        b.add(quad({-1.2f, 0, 1.2f}, {2.4f, 0, 0}, {0, 0, -2.4f}));
        b.add(quad({-3, 0.9f, 3}, {0, 0, -6}, {6, 0, 0}, b.add(glass(1.5f, 0.6f))));
        b.add(quad({1.1f, 0.4f, -0.5f}, {0, 0, 0.9f}, {-0.2f, 0.4f, 0}, b.add(emitter(Rgb(9.0f)))));
        b.add(lookAt({0, 2.2, 1.2}, {0, 0, 0}, 40));
        scenes.push_back({"camera in rough glass", b, 2, 3});
    }
    {
        TechniqueScene s{"coloured coat and clearcoat", plates(true), 2, 3};
        SceneBuilder& b = s.builder;
        lacuna::Material lacquer = plastic({0.2f, 0.4f, 0.6f}, 0.7f);
        lacquer.specularColor = {4, 1, 0.5f};
        lacquer.clearcoat = 0.8f;
        lacquer.clearcoatRoughness = 0.6f;
        b.d.meshes[0].material = b.add(lacquer);
        lacquer.metallic = 1;
        b.add(sphere({0, 0.6f, 0}, 0.35f, 12, b.add(lacquer), true));
        addQuadLight(b);
        scenes.push_back(s);
    }
    {
        // A leaf between light and floor, cloth, and a brushed ball under lacquer.
        TechniqueScene s{"leaf, cloth, brushed metal and lacquer", plates(true), 2, 3};
        SceneBuilder& b = s.builder;
        lacuna::Material cloth = matte({0.5f, 0.3f, 0.3f});
        cloth.sheenColor = {0.9f, 0.8f, 0.4f};
        cloth.sheenRoughness = 0.5f;
        b.d.meshes[0].material = b.add(cloth);
        lacuna::Material paper = plastic({0.5f, 0.6f, 0.2f}, 0.7f);
        paper.diffuseTransmission = 0.6f;
        paper.diffuseTransmissionColor = {0.4f, 0.9f, 0.3f};
        b.add(quad({-0.8f, 0.9f, -0.6f}, {1.6f, 0, 0}, {0, 0.1f, 1.4f}, b.add(paper)));
        lacuna::Material brushed = metal({0.9f, 0.7f, 0.5f}, 0.6f);
        brushed.anisotropy = 0.6f;
        brushed.anisotropyRotation = 0.5f;
        brushed.normalTexture = b.add(strongBumps());
        brushed.clearcoat = 0.8f;
        brushed.clearcoatRoughness = 0.6f;
        b.add(sphere({0.3f, 0.45f, 0.2f}, 0.35f, 12, b.add(brushed), true));
        addQuadLight(b);
        scenes.push_back(s);
    }
    {
        // A plate of coloured glass with a matte sheet in it, between light and floor. Edges go from face to face, and
        // from either face to a surface that says nothing about the glass.
        TechniqueScene s{"coloured rough glass", plates(false), 2, 4};
        SceneBuilder& b = s.builder;
        const auto rough = b.add(colouredGlass({3, 1, 0.2f}, 1.3f, 0.95f));
        b.add(quad({-0.8f, 1.1f, -0.6f}, {0, 0.1f, 1.4f}, {1.6f, 0, 0}, rough));
        b.add(quad({-0.8f, 0.5f, -0.6f}, {1.6f, 0, 0}, {0, 0.1f, 1.4f}, rough));
        b.add(quad({-0.4f, 0.85f, 0}, {0.3f, 0, 0}, {0, 0.1f, 0.4f}));
        addQuadLight(b);
        scenes.push_back(s);
    }
    {
        // The camera is inside coloured glass, one face of which glows on both sides. Light leaves its back into the
        // glass, and meets a floor there that says nothing about the glass.
        SceneBuilder b;
        const auto rough = b.add(colouredGlass({1.5f, 0.5f, 0.1f}, 1.3f, 0.9f));
        lacuna::Material glow = b.d.materials[rough];
        glow.emission = Rgb(4.0f);
        glow.doubleSided = true;
        b.add(quad({-1.2f, 0, 1.2f}, {2.4f, 0, 0}, {0, 0, -2.4f}));
        b.add(quad({-1, 0.4f, -1.3f}, {0, 1, -0.2f}, {2, 0, 0}, rough));
        b.add(quad({-0.4f, 1.5f, -0.3f}, {0, 0, 0.6f}, {0.8f, 0, 0}, b.add(glow)));
        b.add(lookAt({0, 0.9, 2.5}, {0, 0.2, 0}, 40));
        scenes.push_back({"glow in coloured glass", b, 2, 3});
    }
    {
        TechniqueScene s{"instanced and mirrored emitters", plates(false), 2, 3};
        SceneBuilder& b = s.builder;
        Mesh lamp = joined(quad({-0.2f, 0, -0.2f}, {0.4f, 0, 0}, {0, 0.1f, 0.4f}),
                           triangle({-0.2f, 0, 0.4f}, {0.2f, 0, 0.4f}, {0, 0.1f, 0.7f}));
        lamp.material = b.add(emitter({6, 4, 3}));
        const auto mesh = b.add(lamp, translation({-0.6, 1.6, 0.3}));
        b.instance(mesh, translation({0.7, 1.5, 0.3}) * scaling({-1.3, 1, 0.7}));
        b.instance(mesh, translation({0, 2, 0.5}) * rotation({0, 0, 1}, 180) * scaling({1, -1, 1}));
        scenes.push_back(s);
    }
    {
        TechniqueScene s{"lamps with alpha", plates(false), 1, 3};
        addLight(s.builder, LightChoice::VeiledTexture);
        addLight(s.builder, LightChoice::MaskedTexture);
        scenes.push_back(s);
    }
    {
        TechniqueScene s{"environment", plates(false), 1, 3};
        s.builder.add(sphere({0, 0.6f, 0}, 0.35f, 12, 0));
        s.builder.environment(sunnySky());
        s.settings = {"lamps=power"};  // lamps=seen leaves a part to hits
        s.iterations = 60;
        scenes.push_back(s);
    }
    {
        TechniqueScene s{"spot and point", plates(false), 2, 4};
        s.builder.add(sphere({0, 0.6f, 0}, 0.35f, 12, 0, true));
        s.builder.add(spotLight({0.5, 2.2, 1}, {-0.2, -1, -0.4}, Rgb(5.0f), 0.3, 0.6));
        s.builder.add(pointLight({-1, 1.7, 0.6}, Rgb(1.0f)));
        s.complete = withoutHits;
        scenes.push_back(s);
    }
    {
        TechniqueScene s{"directional", plates(true), 2, 3};
        s.builder.add(sphere({0, 0.6f, 0}, 0.35f, 12, 0, true));
        s.builder.add(directionalLight({0.3, -1, -0.6}, Rgb(2.0f)));
        s.complete = withoutHits;
        scenes.push_back(s);
    }
    return scenes;
}

class TechniquesSlow : public testing::TestWithParam<TechniqueScene> {};

TEST_P(TechniquesSlow, unweightedImagesAgree) {
    const TechniqueScene& s = GetParam();
    const auto scene = s.builder.build();
    const MethodRow row = rowNamed("bpt");  // has every strategy, with one sample of each
    Shot shot;
    shot.maxDepth = s.maxEdges;
    shot.lightPaths = 1024;
    shot.iterations = s.iterations;
    shot.settings = s.settings;
    std::vector<std::vector<Moments>> mean(std::size_t(s.maxEdges) + 2,
                                           std::vector<Moments>(std::size_t(s.maxEdges) + 2));
    for (int batch = 0; batch < kBatches; ++batch) {
        TechniqueFilm film(shot.width, shot.height, shot.maxDepth);
        shot.techniques = &film;
        shot.seed = std::uint64_t(batch) + 1;
        render(*scene, row, shot);
        for (int k = s.minEdges; k <= s.maxEdges; ++k) {
            for (int t = 1; t <= k + 1; ++t) {
                double sum = 0;
                for (const Rgb& c : film.unweighted(k + 1 - t, t).pixels)
                    sum += double(lacuna::mean(c));
                mean[std::size_t(k)][std::size_t(t)].add(sum / double(shot.width * shot.height));
            }
        }
    }
    double worst = 0;
    for (int k = s.minEdges; k <= s.maxEdges; ++k) {
        const auto& row_ = mean[std::size_t(k)];
        int best = 0;
        for (int t = 1; t <= k + 1; ++t) {
            const auto relative = [&](int i) {
                return row_[std::size_t(i)].standardError() / row_[std::size_t(i)].mean();
            };
            if (s.complete(k + 1 - t, t) && (best == 0 || relative(t) < relative(best))) best = t;
        }
        const Moments& reference = row_[std::size_t(best)];
        EXPECT_GT(reference.mean(), 0);
        for (int t = 1; t <= k + 1; ++t) {
            if (!s.complete(k + 1 - t, t)) continue;
            const Moments& m = row_[std::size_t(t)];
            const double error = std::hypot(m.standardError(), reference.standardError());
            std::printf("    k %d, s %d, t %d: %.5f +- %.2f %%\n", k, k + 1 - t, t, m.mean(),
                        100 * m.standardError() / m.mean());
            if (t == best) continue;
            worst = std::max(worst, std::fabs(m.mean() - reference.mean()) / (5.5 * error));
            // Student's t with 39 degrees of freedom: 5.5 is exceeded in 3e-6 of the comparisons.
            EXPECT_NEAR(m.mean(), reference.mean(), 5.5 * error)
                << s.name << ", " << k << " edges: t = " << t << " against t = " << best;
        }
    }
    stabilityCase("strategies-alone", worst, kOfAllowed);
}

INSTANTIATE_TEST_SUITE_P(All, TechniquesSlow, testing::ValuesIn(techniqueScenes()), ByParameter());

}  // namespace
}  // namespace lacuna::test
