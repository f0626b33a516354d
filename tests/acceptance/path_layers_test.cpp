// Layers of light path expressions: each holds the paths that its expression matches, whichever technique made them.
// Expressions that divide all paths among them add up to the picture.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "libcore/base/error.h"
#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

using NamedTexts = std::vector<std::pair<std::string, std::string>>;

std::vector<LayerExpression> expressions(const NamedTexts& texts) {
    std::vector<LayerExpression> all;
    for (const auto& [name, text] : texts) {
        LayerExpression e{name, text, "--layer " + name + "=" + text, {}};
        e.parsed = parseExpression(text, e.title);
        all.push_back(std::move(e));
    }
    return all;
}

/// Every kind of scattering: matte, coated, metal, mirrors, smooth and rough glass, thin and solid; every kind of
/// light. Names tell the things apart.
SceneBuilder everyEvent() {
    SceneBuilder b;
    const auto named = [&](const char* name, lacuna::Material m) {
        m.name = name;
        return b.add(m);
    };
    lacuna::Material sheet = glass(1.5f, 0.4f);
    sheet.thin = true;
    b.add(quad({-1.5f, 0, 1.5f}, {3, 0, 0}, {0, 0, -3},
               named("floor", plastic({0.7f, 0.4f, 0.2f}, 0.4f))));
    b.add(sphere({0.6f, 0.4f, 0}, 0.35f, 12, named("ball", glass(1.5f, 0.3f)), true));
    b.add(sphere({-0.6f, 0.4f, 0.1f}, 0.35f, 12, named("drop", glass(1.5f)), true));
    b.add(sphere({0, 0.3f, 0.6f}, 0.25f, 12, named("pot", metal(Rgb(0.9f), 0.3f)), true));
    b.add(quad({-1.5f, 0, -1.2f}, {3, 0, 0}, {0, 2, 0}, named("mirror", mirror(Rgb(0.8f)))));
    b.add(quad({-1.4f, 0, 1}, {0, 0, -2}, {0, 2, 0}, named("sheet", sheet)));
    b.add(quad({1.4f, 0, -1}, {0, 0, 2}, {0, 2, 0}));
    b.add(quad({-0.4f, 1.6f, 0.2f}, {0.8f, 0, 0}, {0, 0.1f, 0.7f},
               named("lamp", emitter({2, 1, 1}, false, Rgb(0.5f)))));
    PunctualLight bulb = pointLight({-0.9, 1.1, 0.6}, {0.3f, 0.5f, 0.3f});
    bulb.names = {"bulb"};
    b.add(bulb);
    b.d.environment = EnvironmentDescription{};
    b.d.environment->colour = Rgb{0.1f, 0.1f, 0.2f};
    b.add(lookAt({0.2, 0.9, 2.6}, {0, 0.5, 0}, 55));
    return b;
}

/// Each family divides all paths among its layers.
const std::vector<NamedTexts>& families() {
    static const std::vector<NamedTexts> all = {
        {{"light", "CL"}, {"diffuse", "CD.*"}, {"glossy", "CG.*"}, {"singular", "CS.*"}},
        {{"some", "C.*<TS>.*L"}, {"none", "C[^<TS>]*L"}},
        {{"even", "C(..)*L"}, {"odd", "C.(..)*L"}},
        {{"evenly", "C([^D]*D[^D]*D)*[^D]*L"}, {"oddly", "C[^D]*D([^D]*D[^D]*D)*[^D]*L"}},
        {{"last-diffuse", "C.*DL"}, {"last-other", "C(.*[^D])?L"}},
        {{"meshes", "C.*O"}, {"sky", "C.*B"}, {"lamps", "C.*<L.'bulb'>"}},
        {{"by-floor", "C.*'floor'.*"}, {"by-others", "C[^'floor']*"}},
        // These two families do not fit into one automaton together.
        {{"deep-diffuse", "C.*D.{7}L"}, {"others", "C(.{0,7}|.*[^D].{7})L"}},
        {{"deep-glossy", "C.*G.{7}L"}, {"and-others", "C(.{0,7}|.*[^G].{7})L"}},
    };
    return all;
}

NamedTexts allOfThem() {
    NamedTexts all;
    for (const NamedTexts& family : families()) all.insert(all.end(), family.begin(), family.end());
    return all;
}

class PathLayersOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, PathLayersOf, testing::ValuesIn(rowNamesOfWeights()), ByParameter());

TEST_P(PathLayersOf, AddUpToThePicture) {
    const auto scene = everyEvent().build();
    Shot shot;
    shot.iterations = 12;
    shot.maxDepth = 9;
    shot.radius = 0.1;  // of merging, large enough that there are merges
    const PathLayers paths(*scene, true, expressions(allOfThem()));
    shot.layers = &paths;
    const Picture p = render(*scene, rowNamed(GetParam()), shot);
    const Image picture = p.pixels.image();
    const Layers& layers = p.layers;

    std::vector<NamedTexts> sums = families();
    sums.push_back({{"light.lamp", ""}, {"light.unnamed", ""}, {"light.environment", ""}});
    const std::array<std::string, 3> channels{".R", ".G", ".B"};
    for (const NamedTexts& family : sums) {
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
                const Rgb& pixel = picture.pixels[i];
                const double whole = c == 0 ? pixel.r : c == 1 ? pixel.g : pixel.b;
                double sum = 0.0;
                for (const auto& [name, text] : family) {
                    const float value = layers.at(name + channels[c])[i];
                    ASSERT_GE(value, 0.0f) << name;
                    sum += double(value);
                }
                ASSERT_NEAR(sum, whole, 1e-6 * whole) << family[0].first << channels[c] << " " << i;
            }
        }
        for (const auto& [name, text] : family) {
            const std::vector<float>& plane = layers.at(name + ".G");
            double energy = 0.0;
            for (const float value : plane) energy += double(value);
            // Splats alone see nothing through mirrors and glass; few paths are that long.
            EXPECT_TRUE(energy > 0.0 || name == "singular" || name.starts_with("deep")) << name;
        }
    }
}

/// Sums of layers over pixels and channels: their means over 12 independent renders, and the error of those.
std::vector<Moments> meansOf(const Scene& scene, const std::string& row, const PathLayers& paths,
                             Shot shot) {
    std::vector<Moments> means(paths.names().size());
    shot.layers = &paths;
    for (shot.seed = 1; shot.seed <= 12; ++shot.seed) {
        const Layers layers = render(scene, rowNamed(row), shot).layers;
        for (std::size_t i = 0; i < means.size(); ++i) {
            double sum = 0.0;
            for (const char* channel : {".R", ".G", ".B"}) {
                for (const float value : layers.at(paths.names()[i] + channel))
                    sum += double(value);
            }
            means[i].add(sum);
        }
    }
    return means;
}

class PathLayersSameAs : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, PathLayersSameAs,
                         testing::Values("bpt", "lvcbpt", "risbpt", "tsrbpt", "spcbpt", "icbpt",
                                         "vcm"),
                         ByParameter());

TEST_P(PathLayersSameAs, OfAPathTracer) {
    SceneBuilder b = everyEvent();
    b.d.lights.clear();  // a path tracer finds no point light behind glass
    const auto scene = b.build();
    const NamedTexts texts = {{"direct", "C[DG]L"},
                              {"caustics", "C<RD>[GS]+L"},
                              {"through", "C.*<TS>.*L"},
                              {"rough", "C.*<TG>.*L"},
                              {"indirect", "CDD+L"},
                              {"seen-in-mirrors", "C<RS'mirror'>+D.*"},
                              {"lamp-on-floor", "C'floor'<L.'lamp'>"},
                              {"bright-pot", "C.*<RG'pot'>.*O"}};
    const PathLayers paths(*scene, false, expressions(texts));
    Shot shot;
    shot.width = shot.height = 8;
    shot.iterations = 160;
    static const std::vector<Moments> expected = meansOf(*scene, "pt", paths, shot);
    const std::vector<Moments> found = meansOf(*scene, GetParam(), paths, shot);
    const double allowed = allowedErrors(kFalseAlarm, double(texts.size()), 11.0);
    for (std::size_t i = 0; i < texts.size(); ++i) {
        EXPECT_GT(found[i].mean(), 0.0) << texts[i].first;
        const double error = std::hypot(expected[i].standardError(), found[i].standardError());
        EXPECT_NEAR(found[i].mean(), expected[i].mean(), allowed * error) << texts[i].first;
        // Or the test could not fail.
        EXPECT_LT(error, 0.1 * expected[i].mean()) << texts[i].first;
    }
}

// A coated ball under a sun: what the coat adds is the glossy layer, and it is the picture of a ball whose base
// scatters nothing.
TEST(PathLayers, OfLobesAreThePicturesOfThoseLobes) {
    const auto floor = [](bool base, bool coat) {
        SceneBuilder b;
        lacuna::Material m = plastic({0.7f, 0.4f, 0.2f}, 0.45f);
        m.clearcoat = 0.6f;
        m.clearcoatRoughness = 0.3f;
        if (!base) m.without.add(LobeKind::Diffuse);
        if (!coat) m.without.add(LobeKind::Glossy);
        b.add(sphere({0, 0, 0}, 1, 12, b.add(m), true));
        b.add(directionalLight({-0.3, -1, -0.8}, {3, 2, 1}));
        b.add(lookAt({0, 0.8, 3}, {0, 0, 0}, 45));
        return b.build();
    };
    Shot shot;
    shot.maxDepth = 2;
    shot.iterations = 16;
    const auto both = floor(true, true);
    const PathLayers paths(*both, false, expressions({{"base", "C<RD>L"}, {"coat", "C<RG>L"}}));
    shot.layers = &paths;
    const Layers layers = render(*both, rowNamed("pt"), shot).layers;
    shot.layers = nullptr;
    const Image coat = render(*floor(false, true), rowNamed("pt"), shot).pixels.image();
    double sums[2] = {0.0, 0.0};
    for (std::size_t i = 0; i < coat.pixels.size(); ++i) {
        const float whole = coat.pixels[i].g;
        EXPECT_NEAR(layers.at("coat.G")[i], whole, 1e-5f + 1e-4f * whole) << i;
        sums[0] += double(layers.at("base.G")[i]);
        sums[1] += double(whole);
    }
    EXPECT_GT(sums[0], 1.0);
    EXPECT_GT(sums[1], 1.0);
}

// Glass that is half a leaf: light passes it as diffuse and as glossy light, and both layers add up to all of it.
TEST(PathLayers, TransmissionIsDividedAsReflectionIs) {
    const auto sheet = [](bool base, bool rough) {
        SceneBuilder b;
        lacuna::Material m = glass(1.5f, 0.6f);
        m.thin = true;
        m.transmission = 0.5f;
        m.specular = 0;
        m.diffuseTransmission = 0.8f;
        if (!base) {
            m.without.add(LobeKind::Diffuse);
            m.without.add(LobeKind::DiffuseTransmission);
        }
        if (!rough) m.without.add(LobeKind::RoughThinTransmission);
        b.add(quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, b.add(m)));
        b.add(directionalLight({0.3, 0.2, 1}, {3, 2, 1}));
        b.add(lookAt({0, 0.3, 3}, {0, 0, 0}, 45));
        return b.build();
    };
    Shot shot;
    shot.maxDepth = 2;
    shot.iterations = 16;
    const auto both = sheet(true, true);
    const PathLayers paths(*both, false,
                           expressions({{"base", "C<TD>L"}, {"glass", "C<TG>L"}, {"all", "C.L"}}));
    shot.layers = &paths;
    const Layers layers = render(*both, rowNamed("pt"), shot).layers;
    shot.layers = nullptr;
    const Image base = render(*sheet(true, false), rowNamed("pt"), shot).pixels.image();
    const Image rough = render(*sheet(false, true), rowNamed("pt"), shot).pixels.image();
    double sums[2] = {0.0, 0.0};
    for (std::size_t i = 0; i < base.pixels.size(); ++i) {
        EXPECT_NEAR(layers.at("base.G")[i], base.pixels[i].g, 1e-5f + 1e-4f * base.pixels[i].g);
        EXPECT_NEAR(layers.at("glass.G")[i], rough.pixels[i].g, 1e-5f + 1e-4f * rough.pixels[i].g);
        EXPECT_NEAR(layers.at("all.G")[i], layers.at("base.G")[i] + layers.at("glass.G")[i], 1e-5f);
        sums[0] += double(base.pixels[i].g);
        sums[1] += double(rough.pixels[i].g);
    }
    EXPECT_GT(sums[0], 1.0);
    EXPECT_GT(sums[1], 1.0);
}

// A smooth coat reflects nothing of a sun, which no walk can hit. So all that connections find is light of the base,
// though walks also go on by the coat.
TEST(PathLayers, OfConnectionsAreOfWhatTheyEvaluate) {
    SceneBuilder b;
    b.add(sphere({0, 0, 0}, 1, 12, b.add(plastic({0.7f, 0.4f, 0.2f}, 0)), true));
    b.add(directionalLight({-0.3, -1, -0.8}, {3, 2, 1}));
    b.add(lookAt({0, 0.8, 3}, {0, 0, 0}, 45));
    const auto scene = b.build();
    const PathLayers paths(*scene, false, expressions({{"base", "C<RD>L"}, {"coat", "C<RS>L"}}));
    Shot shot;
    shot.iterations = 16;
    shot.layers = &paths;
    const Picture p = render(*scene, rowNamed("pt"), shot);
    const Image picture = p.pixels.image();
    const Layers& layers = p.layers;
    double energy = 0.0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const float whole = picture.pixels[i].g;
        EXPECT_NEAR(layers.at("base.G")[i], whole, 1e-6f * whole);
        EXPECT_EQ(layers.at("coat.G")[i], 0.0f);
        energy += double(whole);
    }
    EXPECT_GT(energy, 1.0);
}

// Paths of one edge are light that the camera sees, and paths of two edges scatter once.
TEST(PathLayers, OfShortPathsAreThePicturesOfThose) {
    const auto scene = everyEvent().build();
    const PathLayers paths(*scene, false,
                           expressions({{"seen", "CL"}, {"direct", "C.L"}, {"all", "C.*"}}));
    const auto upTo = [&](int maxDepth) {
        Shot shot;
        shot.maxDepth = maxDepth;
        shot.iterations = 8;
        shot.layers = &paths;
        return render(*scene, rowNamed("bpt"), shot);
    };
    const Picture one = upTo(1), two = upTo(2);
    const Image seen = one.pixels.image(), lit = two.pixels.image();
    const Layers &ofOne = one.layers, &ofTwo = two.layers;
    double energy = 0.0;
    for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
        EXPECT_FLOAT_EQ(ofOne.at("seen.G")[i], seen.pixels[i].g);
        EXPECT_EQ(ofOne.at("direct.G")[i], 0.0f);
        const float whole = lit.pixels[i].g;
        EXPECT_NEAR(ofTwo.at("seen.G")[i] + ofTwo.at("direct.G")[i], whole, 1e-6f * whole);
        EXPECT_NEAR(ofTwo.at("all.G")[i], whole, 1e-6f * whole);
        energy += double(seen.pixels[i].g);
    }
    EXPECT_GT(energy, 0.0);
}

TEST(PathLayers, AreTheSameOnAnyNumberOfThreads) {
    const auto scene = everyEvent().build();
    const PathLayers paths(*scene, true, expressions(allOfThem()));
    std::vector<Layers> layers;
    for (const int threads : {1, 3}) {
        const ThreadPool own(threads);
        Shot shot;
        shot.iterations = 5;
        shot.threads = &own;
        shot.layers = &paths;
        layers.push_back(render(*scene, rowNamed("bpt"), shot).layers);
    }
    EXPECT_EQ(layers[0], layers[1]);
}

TEST(PathLayers, NodesAndMaterialsTellObjectsApart) {
    SceneBuilder b;
    const lacuna::Mesh tile = quad({-1, 0, 0.9f}, {0.9f, 0, 0}, {0, 0, -1.8f});
    const auto mesh = b.add(tile);
    b.d.nodeNames = {"left", "right"};
    b.d.instances.back().nodeName = 0;
    b.instance(mesh, translation({1.1, 0, 0}));
    b.d.instances.back().nodeName = 1;
    b.d.materials[0].name = "tile";
    b.add(directionalLight({0, -1, 0}, Rgb(1.0f)));
    b.add(lookAt({0, 3, 0}, {0, 0, 0}, 40, {0, 0, -1}));
    const auto scene = b.build();
    const PathLayers paths(
        *scene, false,
        expressions(
            {{"l", "C'left'L"}, {"r", "C'right'L"}, {"t", "C'tile'L"}, {"n", "C[^'left']L"}}));
    Shot shot;
    shot.iterations = 4;
    shot.layers = &paths;
    const Picture p = render(*scene, rowNamed("pt"), shot);
    const Image picture = p.pixels.image();
    const Layers& layers = p.layers;
    for (int y = 0; y < shot.height; ++y) {
        for (int x = 0; x < shot.width; ++x) {
            const auto i = std::size_t(y * shot.width + x);
            const float whole = picture.pixels[i].g;
            const bool left = x < shot.width / 2;
            EXPECT_NEAR(layers.at("l.G")[i], left ? whole : 0.0f, 1e-6f);
            EXPECT_NEAR(layers.at("r.G")[i], left ? 0.0f : whole, 1e-6f);
            EXPECT_NEAR(layers.at("n.G")[i], left ? 0.0f : whole, 1e-6f);
            EXPECT_NEAR(layers.at("t.G")[i], whole, 1e-6f);
        }
    }
    EXPECT_GT(picture.at(3, 8).g, 0.0f);
    EXPECT_GT(picture.at(12, 8).g, 0.0f);
}

TEST(PathLayers, RefuseNamesThatNothingBears) {
    const auto scene = everyEvent().build();
    try {
        const PathLayers paths(*scene, false, expressions({{"x", "C<R.'flor'>L"}}));
        ADD_FAILURE() << "there is no flor";
    } catch (const UsageError& e) {
        EXPECT_STREQ(e.what(),
                     "--layer x=C<R.'flor'>L: position 6: expected the name of a light, node or "
                     "material (ball, bulb, drop, environment, floor, lamp, mirror, pot, sheet), "
                     "found \"flor\"");
    }
}

}  // namespace
}  // namespace lacuna::test
