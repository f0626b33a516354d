// lacuna-relight, and the noise of light groups that it reads.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libcore/base/error.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "render/relight.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

using Factors = std::map<std::string, std::array<double, 3>>;

std::vector<double> numbers(const Image& image) {
    std::vector<double> values;
    for (const Rgb& p : image.pixels) {
        for (const float v : {p.r, p.g, p.b}) values.push_back(double(v));
    }
    return values;
}

std::string refusal(const auto& action) {
    try {
        action();
    } catch (const Error& e) {
        return e.what();
    }
    return "nothing was refused";
}

/// A ceiling lamp and a bulb.
class Relight : public RenderTool {
  protected:
    void SetUp() override {
        RenderTool::SetUp();
        write("room.gltf", room(1.0, 2.0));
    }

    /// The scene with these intensities. They are factors of the layers "light.lamp" and "light.unnamed".
    static std::string room(double lamp, double bulb) {
        TinyScene scene;
        scene.pointLight = true;
        scene.pointIntensity = bulb;
        nlohmann::json root = nlohmann::json::parse(scene.text());
        auto& material = root["materials"][4];
        material["name"] = "lamp";
        for (auto& v : material["emissiveFactor"]) v = v.get<double>() * lamp;
        return root.dump();
    }

    Outcome relight(const std::string& arguments) const { return run(arguments, LACUNA_RELIGHT); }

    LayeredImage rendered(const std::string& options) const {
        const Outcome o = run(quick("bpt", "--quiet " + options));
        EXPECT_EQ(o.exitCode, 0) << o.err;
        return readExrLayers(path("out.exr"));
    }
};

TEST_F(Relight, factorsMultiplyTheLayersAndTheirSumIsThePicture) {
    const LayeredImage image = rendered("--light-noise --techniques --layer x=CL");
    ASSERT_EQ(relight("@out.exr -o @new.exr --light lamp=3,5,0 --light unnamed=0.5 --json @o.json")
                  .exitCode,
              0);
    const LayeredImage relit = readExrLayers(path("new.exr"));
    const Image lamp = image.rgb("light.lamp"), bulb = image.rgb("light.unnamed");
    for (std::size_t i = 0; i < lamp.pixels.size(); ++i) {
        const Rgb newLamp = lamp.pixels[i] * Rgb(3, 5, 0), newBulb = bulb.pixels[i] * 0.5f;
        EXPECT_EQ(relit.rgb("light.lamp").pixels[i], newLamp);
        EXPECT_EQ(relit.rgb("light.unnamed").pixels[i], newBulb);
        EXPECT_FLOAT_EQ(relit.rgb().pixels[i].r, newLamp.r + newBulb.r);
        EXPECT_EQ(relit.rgb().pixels[i].b, newBulb.b);
    }
    // Geometry and header stay; layers that depend on the old light are removed.
    for (const char* layer : {"albedo.R", "normal.X", "Z"}) {
        EXPECT_EQ(*relit.find(layer), *image.find(layer)) << layer;
    }
    for (const auto& [name, plane] : relit.channels()) {
        EXPECT_FALSE(name.starts_with("weighted") || name.starts_with("x.") ||
                     name.starts_with("variance.s") || name.starts_with("share"))
            << name;
    }
    EXPECT_EQ(relit.attributes.at("commandLine"), image.attributes.at("commandLine"));
    EXPECT_FALSE(relit.attributes.contains("layers"));
    const Factors expected{{"lamp", {3, 5, 0}}, {"unnamed", {0.5, 0.5, 0.5}}};
    EXPECT_EQ(nlohmann::json::parse(std::get<std::string>(relit.attributes.at("relit"))),
              nlohmann::json(expected));
    const double shares = json("o.json")["shares"]["lamp"].get<double>() +
                          json("o.json")["shares"]["unnamed"].get<double>();
    EXPECT_NEAR(shares, 1.0, 1e-6);

    // Relighting a second time gives the header and layers of a single step.
    ASSERT_EQ(relight("@new.exr -o @newer.exr --light unnamed=4").exitCode, 0);
    ASSERT_EQ(relight("@out.exr -o @once.exr --light lamp=3,5,0 --light unnamed=2").exitCode, 0);
    expectSamePicture("newer.exr", "once.exr");
}

TEST_F(Relight, bySameFactorsThePictureIsWhatItWasAndWithoutAGroupWhatTheOthersAre) {
    const LayeredImage image = rendered("--light-groups");
    ASSERT_EQ(relight("@out.exr -o @same.exr --light lamp=1").exitCode, 0);
    const LayeredImage same = readExrLayers(path("same.exr"));
    EXPECT_EQ(same.rgb().pixels, image.rgb().pixels);
    EXPECT_EQ(same.rgb("variance").pixels, image.rgb("variance").pixels);
    ASSERT_EQ(relight("@out.exr -o @twice.exr --light lamp=2 --light unnamed=2").exitCode, 0);
    const Image twice = readExrLayers(path("twice.exr")).rgb("variance");
    EXPECT_FLOAT_EQ(twice.at(3, 4).g, 4 * image.rgb("variance").at(3, 4).g);

    const Outcome off = relight("@out.exr -o @off.exr --light lamp=0");
    ASSERT_EQ(off.exitCode, 0);
    EXPECT_EQ(readImage(path("off.exr")).pixels, image.rgb("light.unnamed").pixels);
    // Layers alone do not tell the noise of their sum.
    EXPECT_FALSE(readExrLayers(path("off.exr")).hasRgb("variance"));
    EXPECT_NE(off.err.find("render with --light-noise"), std::string::npos) << off.err;
}

// Compares the variance with that of single iterations, each relit.
TEST_F(Relight, theNoiseIsThatOfRelitIterations) {
    constexpr int kIterations = 8;
    const std::string factors = " --light lamp=0.25,1,4 --light unnamed=2,0,0.5";
    const LayeredImage whole = rendered("--light-noise --iterations 8");
    ASSERT_EQ(relight("@out.exr -o @whole.exr" + factors).exitCode, 0);
    std::vector<double> sum, squares;
    for (int i = 0; i < kIterations; ++i) {
        rendered("--light-groups --iterations 8 --block-iterations 1 --blocks " +
                 std::to_string(i) + "," + std::to_string(i + 1));
        ASSERT_EQ(relight("--quiet @out.exr -o @one.exr" + factors).exitCode, 0);
        const std::vector<double> one = numbers(readImage(path("one.exr")));
        sum.resize(one.size());
        squares.resize(one.size());
        for (std::size_t p = 0; p < one.size(); ++p) {
            sum[p] += one[p];
            squares[p] += one[p] * one[p];
        }
    }
    const LayeredImage relit = readExrLayers(path("whole.exr"));
    const std::vector<double> variance = numbers(relit.rgb("variance")),
                              picture = numbers(relit.rgb());
    double noisy = 0;
    for (std::size_t p = 0; p < sum.size(); ++p) {
        const double mean = sum[p] / kIterations;
        const double expected = (squares[p] / kIterations - mean * mean) / double(kIterations - 1);
        ASSERT_NEAR(picture[p], mean, 1e-6 * mean) << p;
        ASSERT_NEAR(variance[p], expected, 1e-4 * expected + 1e-6 * mean * mean) << p;
        noisy += expected > 1e-4 * mean * mean ? 1.0 : 0.0;
    }
    EXPECT_GT(noisy, 0.5 * double(sum.size()));

    // With factors of 1 it is the variance of the render, which is computed in another way.
    const std::vector<double> own = numbers(whole.rgb("variance")), mean = numbers(whole.rgb());
    for (std::size_t p = 0; p < own.size(); ++p) {
        const double quadratic = double(numbers(whole.rgb("covariance.g00g00"))[p]) +
                                 2 * numbers(whole.rgb("covariance.g00g01"))[p] +
                                 numbers(whole.rgb("covariance.g01g01"))[p];
        ASSERT_NEAR(quadratic, own[p], 1e-4 * own[p] + 1e-6 * mean[p] * mean[p]) << p;
    }
}

// Compares with a render of the changed lamps, where light paths start with other probabilities.
TEST_F(Relight, agreesWithARenderOfOtherLamps) {
    rendered("--light-noise --iterations 512 --seed 3");
    ASSERT_EQ(relight("@out.exr -o @relit.exr --light lamp=0.1 --light unnamed=3").exitCode, 0);
    write("room.gltf", room(0.1, 6.0));
    const LayeredImage rendering = rendered("--iterations 512 --seed 4");
    const LayeredImage relit = readExrLayers(path("relit.exr"));
    const std::vector<double> a = numbers(relit.rgb()), b = numbers(rendering.rgb()),
                              ofA = numbers(relit.rgb("variance")),
                              ofB = numbers(rendering.rgb("variance"));
    double sum = 0.0, squares = 0.0, worst = 0.0;
    int count = 0;
    for (std::size_t p = 0; p < a.size(); ++p) {
        if (!(ofA[p] + ofB[p] > 0.0)) continue;
        const double z = (a[p] - b[p]) / std::sqrt(ofA[p] + ofB[p]);
        sum += z;
        squares += z * z;
        worst = std::max(worst, std::abs(z));
        ++count;
    }
    ASSERT_GT(count, 1000);
    // A pixel's channels are nearly the same number, and splats correlate neighbours: a third of the numbers counts.
    const double independent = count / 3.0;
    EXPECT_LT(worst, 6.0);
    EXPECT_LT(std::abs(sum / count), 5.0 / std::sqrt(independent));
    EXPECT_NEAR(squares / count, 1.0, 5.0 * std::sqrt(2.0 / independent) + 0.02);
}

TEST_F(Relight, listsGroupsAndMakesPicturesForScreens) {
    rendered("--light-groups");
    const Outcome list = relight("@out.exr");
    EXPECT_EQ(list.exitCode, 0);
    EXPECT_NE(list.out.find("lamp: "), std::string::npos) << list.out;
    EXPECT_NE(list.out.find("unnamed: "), std::string::npos) << list.out;
    EXPECT_EQ(relight("--quiet @out.exr -o @new.png --light lamp=2").exitCode, 0);
    EXPECT_EQ(readImage(path("new.png")).width, 24);
}

TEST_F(Relight, saysWhatIsWrong) {
    rendered("--light-groups");
    const auto refused = [&](const std::string& arguments, int exitCode, const std::string& part) {
        expectFailure(arguments, exitCode, part, LACUNA_RELIGHT);
    };
    refused("@out.exr -o @new.exr --light sun=2", 2,
            "expected a group of this picture (lamp, unnamed), found 'sun'");
    for (const char* text :
         {"lamp", "=2", "lamp=", "lamp=1,2", "lamp=-1", "lamp=red", "lamp=1,2,inf"}) {
        refused("@out.exr -o @new.exr --light " + std::string(text), 2,
                "--light: expected GROUP=FACTOR or GROUP=R,G,B");
    }
    refused("@out.exr -o @new.exr --light lamp=1 --light lamp=2", 2, "'lamp' twice");
    refused("@out.exr -o @new.exr --light lamp=1e300", 2, "choose smaller factors");
    refused("@out.exr --light lamp=2", 2, "--light: expected together with -o");
    refused("@out.exr -o @out.exr --light lamp=2", 2, "out.exr");
    refused("@none.exr -o @new.exr", 3, "none.exr");
    rendered("");
    refused("@out.exr -o @new.exr --light lamp=2", 3, "render it with --light-groups");
    EXPECT_FALSE(exists("new.exr"));
}

TEST(RelightImage, ofADamagedHeaderIsRefused) {
    LayeredImage image(1, 1);
    image.setRgb("", Image(1, 1, Rgb(1)));
    image.setRgb("light.a", Image(1, 1, Rgb(1)));
    const auto said = [&] { return refusal([&] { relight(image, {}, "file"); }); };
    image.attributes["lightGroups"] = std::string("[\"a\"");
    EXPECT_NE(said().find("found a damaged one"), std::string::npos) << said();
    image.attributes["lightGroups"] = std::string("[\"a\", \"b\"]");
    EXPECT_NE(said().find("expected a layer light.b"), std::string::npos) << said();
    image.attributes["lightGroups"] = std::string("[\"a\"]");
    image.attributes["relit"] = std::string("{\"a\": 1}");
    EXPECT_NE(said().find("found a damaged one"), std::string::npos) << said();
    image.attributes.erase("relit");
    EXPECT_EQ(relight(image, {{"a", {0, 1, 2}}}, "file").rgb().at(0, 0), Rgb(0, 1, 2));
    EXPECT_NE(refusal([&] {
                  relight(image, {{"a", {-1, 1, 1}}}, "file");
              }).find("0 or more"),
              std::string::npos);
}

TEST(RelightImage, keepsLayersThatItDoesNotKnow) {
    LayeredImage image(1, 1);
    for (const char* layer : {"", "light.a", "CryptoObject00", "mine", "emission", "part.x"}) {
        image.setRgb(layer, Image(1, 1, Rgb(1)));
    }
    image.channel("A") = {0.5f};
    image.attributes["lightGroups"] = std::string("[\"a\"]");
    image.attributes["layers"] = std::string("{\"mine\": \"CL\"}");
    const LayeredImage relit = relight(image, {}, "file");
    EXPECT_TRUE(relit.hasRgb("CryptoObject00"));
    EXPECT_TRUE(relit.find("A"));
    for (const char* layer : {"mine", "emission", "part.x"}) EXPECT_FALSE(relit.hasRgb(layer));
}

}  // namespace
}  // namespace lacuna::test
