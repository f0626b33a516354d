// What other programs see of Lacuna: the headers of libcore/include and liblacuna.so, and nothing
// else but what method.h brings.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <thread>

#include "lacuna/lacuna.h"
#include "lacuna/method.h"

namespace lacuna {
namespace {

using Pixels = std::vector<float>;

Pixels pixels(const Picture& picture) {
    return {picture.rgb().begin(), picture.rgb().end()};
}

nlohmann::json statistics(const Picture& picture) {
    return nlohmann::json::parse(picture.statistics());
}

constexpr double kPi = 3.14159265358979323846;
const std::array<float, 12> kQuad{-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
const std::array<std::uint32_t, 6> kTwoTriangles{0, 1, 2, 0, 2, 3};

const std::array<float, 8> kUvs{0, 1, 1, 1, 1, 0, 0, 0};  // the picture upright

/// A square of two by two at the origin that faces +Z.
SceneBuilder::Mesh quad(SceneBuilder::Index material) {
    SceneBuilder::Mesh mesh;
    mesh.positions = kQuad;
    mesh.triangles = kTwoTriangles;
    mesh.uvs = kUvs;
    mesh.material = material;
    return mesh;
}

/// Adds only that square, and a camera at this distance that sees `width` of it.
void addSquare(SceneBuilder& scene, const SceneBuilder::Material& material, double distance,
               double width) {
    scene.addInstance(scene.addMesh(quad(scene.addMaterial(material))));
    scene.addCamera({"", SceneBuilder::lookAt({0, 0, distance}, {0, 0, 0}),
                     2 * std::atan(.5 * width / distance), 1.0});
}

Render small(Render render) {
    render.option("width", 8).option("height", 6).option("threads", 2);
    return render;
}

class Library : public ::testing::Test {
  protected:
    void SetUp() override {
        char name[] = "/tmp/lacuna-library-XXXXXX";
        folder_ = ::mkdtemp(name);
        ::setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return folder_ + "/" + name; }

    static Render cornell(const char* method, int iterations) {
        Render render(LACUNA_SCENES "/cornell-box.glb");
        render.option("method", method).option("iterations", iterations);
        return small(std::move(render));
    }

    std::string folder_;
};

TEST_F(Library, makesThePixelsOfTheProgram) {
    const std::string program = LACUNA_RENDER
                                " " LACUNA_SCENES
                                "/cornell-box.glb --quiet --method risbpt --set candidates=50 "
                                "--iterations 3 --width 8 --height 6 --threads 1 -o " +
                                path("program.exr") + " >/dev/null";
    ASSERT_EQ(std::system(program.c_str()), 0);
    const Picture picture = cornell("risbpt", 3).set("candidates", "50").run();
    const Picture theirs = Picture::load(path("program.exr"));
    EXPECT_EQ(pixels(picture), pixels(theirs));
    EXPECT_EQ(picture.channels(), theirs.channels());
    for (const std::string& name : picture.channels()) {
        const auto a = picture.channel(name), b = theirs.channel(name);
        EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << name;
    }
    EXPECT_EQ(picture.width(), 8);
    EXPECT_EQ(picture.height(), 6);
    EXPECT_EQ(statistics(picture).at("method"), "risbpt");
}

TEST_F(Library, saysNothingAndWritesWhatIsAskedFor) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const Picture picture = cornell("bpt", 2).option("output", path("out.exr")).run();
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(pixels(Picture::load(path("out.exr"))), pixels(picture));
    picture.save(path("again.pfm"));
    EXPECT_EQ(pixels(Picture::load(path("again.pfm"))), pixels(picture));
    const Errors none = picture.compare(picture);
    EXPECT_EQ(none.rmse, 0.0);
    EXPECT_GT(picture.compare(cornell("bpt", 1).run()).mape, 0.0);
}

// Irradiance E on a Lambert square: E albedo / pi, in the units of the header.
TEST_F(Library, sceneFromMemoryHasTheUnitsItSays) {
    SceneBuilder::Material grey;
    grey.baseColour = {.5, .25, .125};
    grey.specular = 0.0;
    SceneBuilder scene;
    addSquare(scene, grey, 1.0, .5);
    SceneBuilder::Lamp sun;
    sun.kind = SceneBuilder::Lamp::Kind::Directional;
    sun.intensity = {3 * kPi, 3 * kPi, 3 * kPi};
    scene.addLamp(sun);
    const Picture picture = small(Render(scene)).option("method", "pt").run();
    for (std::size_t i = 0; i < picture.rgb().size(); i += 3) {
        EXPECT_NEAR(picture.rgb()[i], 1.5, 1e-4);
        EXPECT_NEAR(picture.rgb()[i + 1], .75, 1e-4);
        EXPECT_NEAR(picture.rgb()[i + 2], .375, 1e-4);
    }
}

TEST_F(Library, lampsAreChangedAfterwards) {
    SceneBuilder::Material grey;
    SceneBuilder scene;
    addSquare(scene, grey, 1.0, .5);
    const Picture picture = small(Render(scene))
                                .option("method", "pt")
                                .option("env-colour", "1,2,3")
                                .option("light-groups", true)
                                .run();
    const Picture relit = picture.relight({{"environment", {2, 1, 0}}});
    for (std::size_t i = 0; i < picture.rgb().size(); i += 3) {
        EXPECT_FLOAT_EQ(relit.rgb()[i], 2 * picture.rgb()[i]);
        EXPECT_EQ(relit.rgb()[i + 1], picture.rgb()[i + 1]);
        EXPECT_EQ(relit.rgb()[i + 2], 0.0f);
    }
    EXPECT_TRUE(statistics(relit).contains("relit"));
    EXPECT_THROW(picture.relight({{"sun", {1, 1, 1}}}), UsageError);
    EXPECT_THROW(cornell("pt", 1).run().relight({}), InputError);
}

TEST_F(Library, texturesLieAsTheirRowsDo) {
    SceneBuilder::Material lamp;
    lamp.baseColour = {0, 0, 0};
    lamp.emission = {4, 4, 4};
    // Red, green above blue, white: sRGB 255 is 1.
    const std::array<std::uint8_t, 16> texels{255, 0, 0,   255, 0,   255, 0,   255,
                                              0,   0, 255, 255, 255, 255, 255, 255};
    SceneBuilder scene;
    lamp.emissionTexture = scene.addTexture(2, 2, texels);
    // The square fills the picture: these pixels lie near the texels' centres.
    addSquare(scene, lamp, 10.0, 2.0);
    Render render(scene);
    render.option("width", 20).option("height", 20).option("method", "pt").option("iterations", 4);
    const Picture picture = render.run();
    const auto at = [&](int x, int y) {
        const float* p = &picture.rgb()[std::size_t(3 * (20 * y + x))];
        return std::array<int, 3>{int(std::lround(p[0])), int(std::lround(p[1])),
                                  int(std::lround(p[2]))};
    };
    EXPECT_EQ(at(5, 5), (std::array{4, 0, 0}));
    EXPECT_EQ(at(14, 5), (std::array{0, 4, 0}));
    EXPECT_EQ(at(5, 14), (std::array{0, 0, 4}));
    EXPECT_EQ(at(14, 14), (std::array{4, 4, 4}));
}

/// Everything that a builder can say, in one scene.
SceneBuilder rich() {
    SceneBuilder scene;
    addSquare(scene, {}, 1.0, .5);
    const std::array<std::uint8_t, 4> texel{200, 100, 50, 128};
    SceneBuilder::Material m;
    m.name = "all of it";
    m.alpha = .9;
    m.metallic = .25;
    m.roughness = .3;
    m.specular = .8;
    m.ior = 1.4;
    m.transmission = .5;
    m.solid = true;
    m.attenuation = {.5, .6, .7};
    m.attenuationDistance = 2.0;
    m.clearcoat = .5;
    m.clearcoatRoughness = .1;
    m.sheen = {.2, .3, .4};
    m.sheenRoughness = .5;
    m.anisotropy = 1.5;  // a warning: it is cut off
    m.anisotropyRotation = 1.0;
    m.diffuseTransmission = .25;
    m.diffuseTransmissionColour = {.5, 1, .5};
    m.emission = {2, 1, 0};
    m.doubleSided = true;
    m.alphaMode = SceneBuilder::Material::Alpha::Mask;
    m.baseColourTexture = m.metallicRoughnessTexture = m.normalTexture = m.emissionTexture =
        m.transmissionTexture = scene.addTexture(1, 1, texel);
    SceneBuilder::Mesh mesh = quad(scene.addMaterial(m));
    const std::array<float, 12> normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    const std::array<float, 16> colours{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    mesh.normals = normals;
    mesh.colours = colours;
    SceneBuilder::Transform behind = SceneBuilder::kIdentity;
    behind[14] = -0.5;
    const SceneBuilder::Index placed = scene.addMesh(mesh);
    scene.addInstance(placed, behind);
    behind[12] = 1.0;
    scene.addInstance(placed, behind);
    for (const auto kind : {SceneBuilder::Lamp::Kind::Point, SceneBuilder::Lamp::Kind::Spot,
                            SceneBuilder::Lamp::Kind::Directional}) {
        scene.addLamp({kind, {3, 2, 1}, SceneBuilder::lookAt({0, 1, 2}, {0, 0, 0}), .1, .5});
    }
    return scene;
}

TEST_F(Library, sceneFromMemoryIsTheSceneThatItSaves) {
    const SceneBuilder scene = rich();
    scene.save(path("scene.glb"));
    std::vector<std::string> warnings;
    const auto listen = [&](const std::string& text) { warnings.push_back(text); };
    const Picture here = small(Render(scene)).option("method", "bpt").onWarning(listen).run();
    const Picture there = small(Render(path("scene.glb"))).option("method", "bpt").run();
    EXPECT_EQ(pixels(here), pixels(there));
    EXPECT_EQ(statistics(here).at("scene_hash"), statistics(there).at("scene_hash"));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("clamped"), std::string::npos) << warnings[0];
    EXPECT_GT(here.rgb()[0], 0.0f);
}

// Trained methods keep their caches in the user's cache folder.
TEST_F(Library, scenesFromMemoryHaveCaches) {
    Render render = small(Render(rich()));
    render.option("method", "spcbpt").option("prepare", true).option("iterations", 2);
    render.set("train.paths", "2000").set("train.light_paths", "2000").set("candidates", "100");
    const Picture first = render.run();
    EXPECT_TRUE(std::filesystem::exists(path("lacuna")));
    render.option("prepare", false);
    EXPECT_EQ(pixels(render.run()), pixels(first));
}

/// An environment variable that has this value for a while.
class Variable {
  public:
    Variable(const char* name, const char* value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = before;
        ::setenv(name, value, 1);
    }
    ~Variable() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    const char* name_;
    std::optional<std::string> before_;
};

TEST_F(Library, scenesFromMemoryNeedNoFolderWithoutCaches) {
    const Picture before = small(Render(rich())).option("method", "bpt").run();
    const Variable cache("XDG_CACHE_HOME", ""), home("HOME", "");
    const Variable temporary("TMPDIR", path("nowhere").c_str());
    EXPECT_EQ(pixels(small(Render(rich())).option("method", "bpt").run()), pixels(before));
}

TEST_F(Library, builderRefusesWhatDoesNotFit) {
    SceneBuilder scene;
    SceneBuilder::Mesh mesh;
    EXPECT_THROW(scene.addMesh(mesh), UsageError);
    mesh.positions = kQuad;
    const std::array<std::uint32_t, 3> beyond{0, 1, 4};
    mesh.triangles = beyond;
    EXPECT_THROW(scene.addMesh(mesh), UsageError);
    mesh.triangles = kTwoTriangles;
    mesh.material = 0;
    EXPECT_THROW(scene.addMesh(mesh), UsageError);
    mesh.material.reset();
    mesh.uvs = std::span(kQuad).first(2);
    EXPECT_THROW(scene.addMesh(mesh), UsageError);
    EXPECT_THROW(scene.addInstance(0), UsageError);
    EXPECT_THROW(scene.addTexture(2, 2, {}), UsageError);
    SceneBuilder::Material material;
    material.normalTexture = 0;
    EXPECT_THROW(scene.addMaterial(material), UsageError);
    EXPECT_THROW(SceneBuilder::lookAt({0, 0, 0}, {0, 1, 0}), UsageError);
    // Not the builder but the renderer refuses a scene without a camera.
    EXPECT_THROW(Render(scene).run(), InputError);
}

TEST_F(Library, errorsAreThoseOfTheProgram) {
    EXPECT_THROW(Render("nowhere.glb").run(), InputError);
    EXPECT_THROW(cornell("nothing", 1).run(), UsageError);
    EXPECT_THROW(cornell("bpt", 1).option("colour", "red").run(), UsageError);
    EXPECT_THROW(cornell("bpt", 0).run(), UsageError);
    EXPECT_THROW(cornell("bpt", 1).option("help", true), UsageError);
    EXPECT_THROW(cornell("bpt", 1).option("list_methods", "1"), UsageError);
    EXPECT_THROW(cornell("bpt", 1).option("output", path("no/such/folder.exr")).run(), RunError);
    EXPECT_THROW(cornell("spcbpt", 1).option("cache", path("empty")).run(), InputError);
    EXPECT_THROW(Picture::load(path("none.exr")), InputError);
}

TEST_F(Library, tellsWhatItDoesAndShowsThePicture) {
    std::vector<std::string> phases;
    std::vector<std::uint64_t> iterations;
    Pixels last;
    Render render = cornell("bpt", 3);
    render.onProgress([&](const RenderProgress& now) {
        if (phases.empty() || phases.back() != now.phase) phases.push_back(now.phase);
        if (!now.preview) return;
        iterations.push_back(now.iterations);
        EXPECT_EQ(now.limit, 3u);
        const RenderProgress::Preview preview = now.preview();
        EXPECT_EQ(preview.width, 8);
        EXPECT_EQ(preview.height, 6);
        last = preview.rgb;
    });
    const Picture picture = render.run();
    EXPECT_EQ(phases,
              (std::vector<std::string>{"loading", "building", "features", "rendering", "saving"}));
    EXPECT_EQ(iterations, (std::vector<std::uint64_t>{1, 2, 3}));
    EXPECT_EQ(last, pixels(picture));
}

TEST_F(Library, askedToStopReturnsWhatThereIs) {
    std::stop_source stop;
    Render render = cornell("bpt", 1000000);
    render.onProgress([&](const RenderProgress& now) {
        if (now.iterations == 2) stop.request_stop();
    });
    const Picture picture = render.run(stop.get_token());
    EXPECT_EQ(statistics(picture).at("stopped"), "interrupt");
    EXPECT_EQ(statistics(picture).at("iterations"), 2);
    EXPECT_EQ(pixels(picture), pixels(cornell("bpt", 2).run()));
}

TEST_F(Library, stoppedBeforeThereIsAnythingThrows) {
    std::stop_source stop;
    Render render = cornell("spcbpt", 10);
    render.option("prepare", true)
        .option("cache", path("cache"))
        .onProgress([&](const RenderProgress& now) {
            if (now.phase.starts_with("preparing")) stop.request_stop();
        });
    EXPECT_THROW(render.run(stop.get_token()), InterruptedError);
}

TEST_F(Library, whatACallbackThrowsComesOut) {
    Render render = cornell("bpt", 1000000);
    render.onProgress([](const RenderProgress& now) {
        if (now.iterations == 1) throw std::logic_error("enough");
    });
    EXPECT_THROW(render.run(), std::logic_error);
}

TEST_F(Library, twoRendersAtOnceDoNotMeet) {
    const Pixels first = pixels(cornell("bpt", 4).run()), second = pixels(cornell("pt", 4).run());
    Pixels a, b;
    std::thread other([&] { a = pixels(cornell("bpt", 4).run()); });
    b = pixels(cornell("pt", 4).run());
    other.join();
    EXPECT_EQ(a, first);
    EXPECT_EQ(b, second);
}

TEST_F(Library, rendersByAMethodFromOutside) {
    MethodRow mine = findMethod("bpt");
    mine.name = "mine";
    Render render = cornell("mine", 2);
    EXPECT_THROW(render.run(), UsageError);
    render.add(mine);
    const Picture picture = render.run();
    EXPECT_EQ(pixels(picture), pixels(cornell("bpt", 2).run()));
    EXPECT_EQ(statistics(picture).at("method"), "mine");
    mine.name = "bpt";
    EXPECT_THROW(render.add(mine), UsageError);
}

}  // namespace
}  // namespace lacuna
