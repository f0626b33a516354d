// The output of lacuna-render: image, layers, header, JSON, curve.
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libcore/bidir/technique_film.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "libcore/methods/registry.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

class RenderOutput : public RenderTool {
  protected:
    std::vector<std::vector<std::string>> csv(const std::string& name) const {
        std::vector<std::vector<std::string>> rows;
        std::istringstream lines(read(name));
        for (std::string line; std::getline(lines, line);) {
            std::vector<std::string> row(1);
            for (const char c : line) {
                if (c == ',') {
                    row.emplace_back();
                } else {
                    row.back() += c;
                }
            }
            rows.push_back(row);
        }
        return rows;
    }
};

template <class T>
T attribute(const LayeredImage& image, const std::string& name) {
    return std::get<T>(image.attributes.at(name));
}

TEST_F(RenderOutput, HeaderSaysHowItWasMade) {
    ASSERT_EQ(run(quick("lvcbpt", "--seed 7 --quiet --set connections=2")).exitCode, 0);
    const LayeredImage image = readExrLayers(path("out.exr"));
    EXPECT_EQ(attribute<std::string>(image, "software"), "Lacuna");
    EXPECT_EQ(attribute<std::string>(image, "softwareVersion").substr(0, 2), "0.");
    EXPECT_NE(attribute<std::string>(image, "commandLine").find("--seed 7"), std::string::npos);
    EXPECT_EQ(attribute<std::string>(image, "method"), "lvcbpt");
    const auto parameters = nlohmann::json::parse(attribute<std::string>(image, "parameters"));
    EXPECT_EQ(parameters.at("candidates"), 100);
    EXPECT_EQ(parameters.at("connections"), 2);
    EXPECT_EQ(parameters.at("next_event"), "off");
    EXPECT_EQ(attribute<int>(image, "seed"), 7);
    EXPECT_EQ(attribute<int>(image, "iterations"), 2);
    EXPECT_GT(attribute<double>(image, "renderTimeSeconds"), 0.0);
    EXPECT_GT(attribute<double>(image, "setupTimeSeconds"), 0.0);
    EXPECT_GT(attribute<double>(image, "rays"), 24 * 16);
    EXPECT_EQ(attribute<int>(image, "invalidSamples"), 0);
    EXPECT_EQ(attribute<std::string>(image, "sceneHash").size(), 32u);
    EXPECT_EQ(attribute<std::string>(image, "cacheHashes"), "{}");
    EXPECT_EQ(attribute<std::string>(image, "stopped"), "iterations");
    EXPECT_FALSE(image.attributes.contains("crop"));
    EXPECT_FALSE(image.attributes.contains("biased"));
}

TEST_F(RenderOutput, NumbersAreTheMethodsUnlessTheCommandLineSaysOtherwise) {
    const auto sampler = [&](const std::string& method, const std::string& more = "") {
        const Outcome o = run(quick(method, more + " --json @o.json"));
        EXPECT_EQ(o.exitCode, 0) << o.err;
        return json("o.json")["sampler"].get<std::string>();
    };
    for (const MethodRow& row : methods()) {
        EXPECT_EQ(sampler(row.name), nameOf(row.sampling)) << row.name;
    }
    EXPECT_EQ(sampler("bpt"), "independent");
    EXPECT_EQ(sampler("bpt", " --sampler sobol"), "sobol");
    EXPECT_EQ(sampler("sharebpt"), "sobol");
    EXPECT_EQ(sampler("sharebpt", " --sampler independent"), "independent");
}

TEST_F(RenderOutput, LayersAreFiniteAndMeanSomething) {
    // Enough iterations for variances.
    ASSERT_EQ(run(quick("bpt", "--quiet --iterations 32")).exitCode, 0);
    const LayeredImage image = readExrLayers(path("out.exr"));
    EXPECT_EQ(image.width(), 24);
    EXPECT_EQ(image.height(), 16);
    for (const char* name :
         {"R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z",
          "Z", "variance.R", "variance.G", "variance.B"}) {
        const std::vector<float>* values = image.find(name);
        ASSERT_NE(values, nullptr) << name;
        for (const float v : *values) ASSERT_TRUE(std::isfinite(v)) << name;
    }
    // The middle pixel sees the back wall: rough metal at z = -1, four units from the camera.
    const std::size_t middle = 8 * 24 + 12;
    EXPECT_NEAR(image.find("Z")->at(middle), 4.0f, 1e-3f);
    EXPECT_NEAR(image.find("normal.Z")->at(middle), 1.0f, 1e-5f);
    EXPECT_NEAR(image.find("albedo.R")->at(middle), 0.9f, 1e-3f);
    EXPECT_NEAR(image.find("albedo.B")->at(middle), 0.5f, 1e-3f);
    EXPECT_GT(image.find("variance.R")->at(middle), 0.0f);
    EXPECT_GT(image.find("R")->at(middle), 0.0f);
    // The upper left pixel sees past the room and hits nothing.
    EXPECT_EQ(image.find("Z")->at(0), 0.0f);
    EXPECT_EQ(image.find("R")->at(0), 0.0f);
    EXPECT_EQ(image.find("normal.X")->at(0), 0.0f);
}

TEST_F(RenderOutput, JsonHasItsKeys) {
    ASSERT_EQ(run(quick("lvcbpt", "--json @out.json --threads 2 --seed 3")).exitCode, 0);
    const nlohmann::json j = json("out.json");
    for (const char* key :
         {"method", "iterations", "seconds", "setup_seconds", "rays", "invalid_samples",
          "peak_bytes", "mean_rgb", "mean_rgb_stderr", "width", "height", "threads", "seed",
          "warmup_iterations", "rays_by_kind", "phases", "effects", "stopped"}) {
        EXPECT_TRUE(j.contains(key)) << key;
    }
    for (const char* phase : {"load", "parse", "decode", "meshes", "build"}) {
        EXPECT_TRUE(j["phases"].contains(phase)) << phase;
    }
    EXPECT_FALSE(j.contains("verify"));
    EXPECT_EQ(j["method"], "lvcbpt");
    EXPECT_EQ(j["iterations"], 2);
    EXPECT_EQ(j["width"], 24);
    EXPECT_EQ(j["height"], 16);
    EXPECT_EQ(j["threads"], 2);
    EXPECT_EQ(j["seed"], 3);
    EXPECT_EQ(j["warmup_iterations"], 1);
    EXPECT_EQ(j["stopped"], "iterations");
    EXPECT_EQ(j["invalid_samples"], 0);
    EXPECT_GT(j["peak_bytes"].get<double>(), 1e6);
    ASSERT_EQ(j["mean_rgb"].size(), 3u);
    ASSERT_EQ(j["mean_rgb_stderr"].size(), 3u);
    EXPECT_GT(j["mean_rgb"][0].get<double>(), 0.0);
    EXPECT_TRUE(j["effects"]["simulated"].is_array());
    EXPECT_TRUE(j["effects"]["left_out"].is_array());
    EXPECT_GT(j["held"]["light vertices"], 0);
    EXPECT_GT(j["held"]["light vertex bytes"], j["held"]["light vertices"]);
    std::uint64_t rays = 0;
    for (const auto& [name, n] : j["rays_by_kind"].items()) rays += n.get<std::uint64_t>();
    EXPECT_EQ(rays, j["rays"].get<std::uint64_t>());
    // mean_rgb is the mean of the image.
    const Image image = readImage(path("out.exr"));
    double sum = 0.0;
    for (const Rgb& p : image.pixels) sum += p.g;
    EXPECT_NEAR(j["mean_rgb"][1].get<double>(), sum / double(image.pixels.size()), 1e-6);
}

TEST_F(RenderOutput, CurveHasItsColumnsAndFewRows) {
    ASSERT_EQ(run(quick("pt", "--quiet --iterations 200 --log @plain.csv")).exitCode, 0);
    const auto plain = csv("plain.csv");
    const std::vector<std::string> header{
        "iteration",  "seconds",    "setup_seconds", "rays",     "mae",        "rmse",
        "mape",       "relmse",     "rays_camera",   "rays_eye", "rays_light", "rays_connection",
        "rays_splat", "rays_cache", "rays_chain",    "phases"};
    ASSERT_GE(plain.size(), 3u);
    EXPECT_EQ(plain[0], header);
    EXPECT_EQ(plain[1][0], "1");
    EXPECT_EQ(plain.back()[0], "200");
    EXPECT_LT(plain.size(), 60u);
    std::map<int, int> perDecade;
    for (std::size_t i = 1; i < plain.size(); ++i) {
        ASSERT_EQ(plain[i].size(), header.size());
        for (std::size_t c = 4; c < 8; ++c) EXPECT_EQ(plain[i][c], "");
        std::uint64_t rays = 0;
        for (std::size_t c = 8; c < 15; ++c) rays += std::stoull(plain[i][c]);
        EXPECT_EQ(rays, std::stoull(plain[i][3]));
        EXPECT_NE(plain[i][15].find("eye paths="), std::string::npos) << plain[i][15];
        if (i + 1 < plain.size()) ++perDecade[int(std::floor(std::log10(std::stod(plain[i][1]))))];
        if (i > 1) {
            EXPECT_GT(std::stod(plain[i][1]), std::stod(plain[i - 1][1]));
            EXPECT_GT(std::stod(plain[i][3]), std::stod(plain[i - 1][3]));
        }
    }
    for (const auto& [decade, rows] : perDecade) EXPECT_LE(rows, 10) << decade;

    // With the 200 iterations as reference, the error falls.
    std::filesystem::rename(path("out.exr"), path("reference.exr"));
    const Outcome o =
        run(quick("pt",
                  "--quiet --iterations 64 --seed 2 --log @curve.csv --reference @reference.exr "
                  "--json @out.json"));
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const auto curve = csv("curve.csv");
    EXPECT_EQ(curve[0], header);
    EXPECT_LT(std::stod(curve.back()[5]), 0.5 * std::stod(curve[1][5]));
    EXPECT_NEAR(json("out.json").at("error").at("rmse").get<double>(), std::stod(curve.back()[5]),
                1e-12);
    EXPECT_NE(o.out.find("relmse"), std::string::npos);
    expectFailure(quick("pt", "--quiet --width 30 --reference @reference.exr"), 3, "24 x 16");
}

TEST_F(RenderOutput, CropHasItsSizeAndItsPixels) {
    // In path tracing, only a pixel's own eye paths add to it, so the crop is the same bit for bit.
    ASSERT_EQ(run(quick("pt", "--quiet")).exitCode, 0);
    const LayeredImage full = readExrLayers(path("out.exr"));
    ASSERT_EQ(run(quick("pt", "--quiet --crop 5,17,3,10 --json @out.json")).exitCode, 0);
    const LayeredImage part = readExrLayers(path("out.exr"));
    ASSERT_EQ(part.width(), 12);
    ASSERT_EQ(part.height(), 7);
    EXPECT_EQ(attribute<std::string>(part, "crop"), "5,17,3,10");
    EXPECT_EQ(attribute<std::string>(part, "fullSize"), "24x16");
    EXPECT_EQ(json("out.json")["width"], 12);
    for (const auto& [name, values] : part.channels()) {
        for (int y = 0; y < 7; ++y) {
            for (int x = 0; x < 12; ++x) {
                ASSERT_EQ(values[std::size_t(y * 12 + x)],
                          full.find(name)->at(std::size_t((y + 3) * 24 + x + 5)))
                    << name << " " << x << " " << y;
            }
        }
    }
}

TEST_F(RenderOutput, CropOfMethodsWithSplatsIsThatPart) {
    // Splats come from the light paths of the full image: they are equal except for the order of
    // additions.
    for (const char* method : {"lt", "bpt", "lvcbpt"}) {
        ASSERT_EQ(run(quick(method, "--quiet")).exitCode, 0);
        const Image full = readImage(path("out.exr"));
        ASSERT_EQ(run(quick(method, "--quiet --crop 5,17,3,10")).exitCode, 0);
        const Image part = readImage(path("out.exr"));
        for (int y = 0; y < 7; ++y) {
            for (int x = 0; x < 12; ++x) {
                const Rgb &a = part.at(x, y), &b = full.at(x + 5, y + 3);
                ASSERT_NEAR(a.r, b.r, 1e-4f * (1.0f + b.r)) << method << " " << x << " " << y;
            }
        }
    }
}

TEST_F(RenderOutput, OtherFormats) {
    const std::string start =
        "@room.gltf --method pt --width 24 --height 16 --iterations 2 --quiet ";
    ASSERT_EQ(run(start + "-o @a.exr").exitCode, 0);
    ASSERT_EQ(run(start + "-o @a.pfm").exitCode, 0);
    ASSERT_EQ(run(start + "-o @a.png --exposure 1 --tone standard").exitCode, 0);
    const Image exr = readImage(path("a.exr")), pfm = readImage(path("a.pfm"));
    EXPECT_EQ(exr.pixels, pfm.pixels);
    const Image png = readImage(path("a.png"));
    for (std::size_t i = 0; i < exr.pixels.size(); ++i) {
        EXPECT_NEAR(png.pixels[i].g, std::min(1.0f, 2.0f * exr.pixels[i].g), 0.01f);
    }
}

TEST_F(RenderOutput, TechniqueLayersAddUpToThePicture) {
    ASSERT_EQ(run(quick("bpt", "--quiet --techniques")).exitCode, 0);
    const LayeredImage image = readExrLayers(path("out.exr"));
    EXPECT_TRUE(image.hasRgb("unweighted.s01t02"));
    std::vector<double> sum(24 * 16, 0.0);
    int layers = 0;
    for (const auto& [name, values] : image.channels()) {
        if (name.substr(0, 9) != "weighted." || name.back() != 'G') continue;
        ++layers;
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[i];
    }
    EXPECT_GT(layers, 10);
    for (std::size_t i = 0; i < sum.size(); ++i) {
        EXPECT_NEAR(sum[i], image.find("G")->at(i), 1e-4) << i;
    }
}

TEST_F(RenderOutput, LightGroupsAddUpToThePicture) {
    TinyScene scene;
    scene.pointLight = true;  // has no name
    nlohmann::json root = nlohmann::json::parse(scene.text());
    root["materials"][4]["name"] = "lamp";
    write("room.gltf", root.dump());
    ASSERT_EQ(run(quick("bpt", "--quiet --light-groups --iterations 6")).exitCode, 0);
    const LayeredImage image = readExrLayers(path("out.exr"));
    const Image picture = image.rgb();
    std::vector<double> sum(picture.pixels.size(), 0.0);
    int layers = 0;
    for (const auto& [name, values] : image.channels()) {
        if (!name.starts_with("light.") || name.back() != 'G') continue;
        ++layers;
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += double(values[i]);
    }
    EXPECT_EQ(layers, 2);
    EXPECT_TRUE(image.hasRgb("light.lamp"));
    EXPECT_TRUE(image.hasRgb("light.unnamed"));
    for (std::size_t i = 0; i < sum.size(); ++i) {
        EXPECT_NEAR(sum[i], picture.pixels[i].g, 1e-6 * (1.0 + picture.pixels[i].g)) << i;
    }
    std::string png = quick("bpt", "--quiet --light-groups");
    png.replace(png.find("out.exr"), 7, "out.png");
    expectFailure(png, 2, "--light-groups: expected an .exr or a --sheet to hold the layers");
}

TEST_F(RenderOutput, LayersOfExpressionsAddUpToThePicture) {
    TinyScene scene;
    scene.pointLight = true;
    nlohmann::json root = nlohmann::json::parse(scene.text());
    root["materials"][0]["name"] = "walls";
    write("room.gltf", root.dump());
    const std::string layers = "--layer \"walls=C'walls'.*\" --layer=\"rest=C[^'walls'].*\"";
    ASSERT_EQ(run(quick("bpt", "--quiet --iterations 6 --json @o.json " + layers)).exitCode, 0);
    const LayeredImage image = readExrLayers(path("out.exr"));
    const Image picture = image.rgb(), walls = image.rgb("walls"), rest = image.rgb("rest");
    double energy = 0.0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const float whole = picture.pixels[i].g;
        EXPECT_NEAR(walls.pixels[i].g + rest.pixels[i].g, whole, 1e-6f * (1.0f + whole)) << i;
        energy += double(walls.pixels[i].g);
    }
    EXPECT_GT(energy, 0.0);
    const nlohmann::json expected = {{"walls", "C'walls'.*"}, {"rest", "C[^'walls'].*"}};
    EXPECT_EQ(json("o.json").at("layers"), expected);
    EXPECT_EQ(nlohmann::json::parse(attribute<std::string>(image, "layers")), expected);

    std::string without = quick("bpt", "--quiet --iterations 6");
    without.replace(without.find("out.exr"), 7, "plain.exr");
    ASSERT_EQ(run(without).exitCode, 0);
    EXPECT_EQ(readExrLayers(path("plain.exr")).rgb().pixels, picture.pixels);
}

TEST_F(RenderOutput, LayersThatCannotBeAreRefused) {
    const auto refused = [&](const std::string& options, const std::string& part) {
        expectFailure(quick("bpt", "--quiet " + options), 2, part);
    };
    refused("--layer 'glass=C<TX>L'",
            "--layer glass=C<TX>L: position 4: expected a scattering letter (D, G, S, s or .), "
            "found \"X\"");
    refused("--layer CL", "--layer: expected NAME=EXPRESSION, found 'CL'");
    refused("--layer a.b=CL", "letters, digits, _ and -, found 'a.b'");
    refused("--layer =CL", "letters, digits, _ and -, found ''");
    refused("--layer albedo=CL", "a name that pictures do not use themselves");
    refused("--layer a=CL --layer a=C.L", "--layer: expected names that differ, found 'a' twice");
    refused("--layer a=LC", "--layer a=LC: expected the way from the camera to a light");
    refused("--layer \"a=C<L.'lamp'>\"", "--layer a=C<L.'lamp'>: position 6: expected the name of");
    refused("--layer 'a=C.*D.{12}L'", "expected an automaton of at most 1000 states");
    refused("--layer a=CL --estimate", "found --layer");
    std::string png = quick("bpt", "--quiet --layer a=CL");
    png.replace(png.find("out.exr"), 7, "out.png");
    expectFailure(png, 2, "--layer: expected an .exr or a --sheet to hold the layers");
}

// A group's layer is the sum of its techniques. The JSON and the table describe the same layers.
TEST_F(RenderOutput, GroupsOfTechniquesHaveEnergyNoiseAndTime) {
    const Outcome o = run(quick("bpt", "--techniques --iterations 32 --json @o.json"));
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const LayeredImage image = readExrLayers(path("out.exr"));
    const Image picture = image.rgb();
    std::vector<double> sum(picture.pixels.size(), 0.0);
    for (std::size_t g = 0; g < TechniqueGroup::kCount; ++g) {
        const std::string name = TechniqueGroup::at(g).name();
        const std::vector<float>* weighted = image.find("weighted." + name);
        EXPECT_EQ(weighted == nullptr, image.find("variance." + name) == nullptr) << name;
        for (std::size_t i = 0; weighted && i < sum.size(); ++i) sum[i] += (*weighted)[i];
    }
    for (std::size_t i = 0; i < sum.size(); ++i) {
        EXPECT_NEAR(sum[i], mean(picture.pixels[i]), 1e-4) << i;
    }
    // A surface seen in the mirror is also a first eye vertex, with t = 3.
    std::vector<float> atTwo(sum.size(), 0.0f);
    for (int s = 2; s <= 5; ++s) {
        const std::string layer = "weighted." + TechniqueFilm::layerName(s, 2);
        const Image own = image.hasRgb(layer) ? image.rgb(layer) : Image(24, 16);
        for (std::size_t i = 0; i < sum.size(); ++i) atTwo[i] += mean(own.pixels[i]);
    }
    int behindTheMirror = 0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
        const float first = image.find("weighted.connections1")->at(i);
        EXPECT_GE(first, 0.99f * atTwo[i]) << i;
        behindTheMirror += first > 0.0f && atTwo[i] == 0.0f;
    }
    EXPECT_GT(behindTheMirror, 5);
    double energy = 0.0, share = 0.0, seconds = 0.0;
    const nlohmann::json report = json("o.json");
    for (const nlohmann::json& row : report.at("techniques")) {
        EXPECT_NE(o.out.find(row.at("technique").get<std::string>()), std::string::npos) << o.out;
        seconds += row.at("seconds").get<double>();
        if (!row.contains("energy")) continue;
        energy += row.at("energy").get<double>();
        share += row.at("variance_share").get<double>();
        EXPECT_GE(row.at("variance").get<double>(), 0.0) << row;
    }
    EXPECT_NEAR(energy, 1.0, 1e-4);
    EXPECT_NEAR(share, 1.0, 1e-9);
    double ofPhases = 0.0;
    for (const char* phase : {"light paths", "eye paths", "prepare", "observe"}) {
        ofPhases += report.at("phases").value(phase, 0.0);
    }
    EXPECT_NEAR(seconds, ofPhases * report.at("threads").get<double>(), 1e-3 * seconds);
    ASSERT_EQ(run(quick("lt", "--quiet --techniques --iterations 8 --json @o.json")).exitCode, 0);
    const nlohmann::json rows = json("o.json").at("techniques");
    EXPECT_EQ(rows.at(0).at("technique"), "splats");
    EXPECT_NEAR(rows.at(0).at("energy").get<double>(), 1.0, 1e-4);
}

TEST_F(RenderOutput, TheShareOfConnectionsAtTheFirstVertex) {
    ASSERT_EQ(run(quick("bpt", "--quiet --techniques")).exitCode, 0);
    const LayeredImage image = readExrLayers(path("out.exr"));
    const std::vector<float>* share = image.find("share.t02");
    ASSERT_NE(share, nullptr);
    const auto grey = [](const Rgb& c) { return (double(c.r) + double(c.g) + double(c.b)) / 3.0; };
    std::vector<double> first(share->size(), 0.0);
    for (int s = 1; s <= 5; ++s) {
        const std::string name = "weighted.s0" + std::to_string(s) + "t02";
        ASSERT_TRUE(image.hasRgb(name)) << name;
        const Image layer = image.rgb(name);
        for (std::size_t i = 0; i < first.size(); ++i) first[i] += grey(layer.pixels[i]);
    }
    const Image picture = image.rgb();
    int between = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        const double total = grey(picture.pixels[i]);
        EXPECT_NEAR(share->at(i), total > 0.0 ? first[i] / total : 0.0, 1e-4) << i;
        between += share->at(i) > 0.05f && share->at(i) < 0.95f;
    }
    // The lamp is seen directly, and what it lights has other techniques as well.
    EXPECT_GT(between, 100);
    // Light tracing has no such connections.
    ASSERT_EQ(run(quick("lt", "--quiet --techniques")).exitCode, 0);
    const LayeredImage traced = readExrLayers(path("out.exr"));
    for (const float v : *traced.find("share.t02")) EXPECT_EQ(v, 0.0f);
}

TEST_F(RenderOutput, SizeDepthAndLensComeFromTheSceneUnlessGiven) {
    TinyScene scene;
    scene.lacuna = {{"width", 20}, {"height", 10}, {"max_depth", 3}};
    write("sized.gltf", scene.text());
    const std::string start = "-o @out.exr --method pt --iterations 1 --quiet --json @o.json ";
    ASSERT_EQ(run(start + "@sized.gltf").exitCode, 0);
    EXPECT_EQ(json("o.json")["width"], 20);
    EXPECT_EQ(json("o.json")["height"], 10);
    EXPECT_EQ(json("o.json")["max_depth"], 3);
    ASSERT_EQ(run(start + "@sized.gltf --width 8 --height 9 --max-depth 2").exitCode, 0);
    EXPECT_EQ(json("o.json")["width"], 8);
    EXPECT_EQ(json("o.json")["height"], 9);
    EXPECT_EQ(json("o.json")["max_depth"], 2);

    scene.lacuna = {{"aperture", 0.2}, {"focus", 3.0}, {"width", 12}, {"height", 8}};
    write("lens.gltf", scene.text());
    ASSERT_EQ(run(start + "@lens.gltf").exitCode, 0);
    const auto has = [&](const char* group) {
        const auto names = json("o.json")["effects"][group];
        return std::find(names.begin(), names.end(), "thin_lens") != names.end();
    };
    EXPECT_TRUE(has("simulated"));
    ASSERT_EQ(run(start + "@lens.gltf --aperture 0").exitCode, 0);
    EXPECT_TRUE(has("left_out"));
}

TEST_F(RenderOutput, OneSideAloneKeepsTheShape) {
    using Size = std::pair<int, int>;
    const auto size = [&](const nlohmann::json& lacuna, const std::string& options) -> Size {
        TinyScene scene;
        scene.lacuna = lacuna;
        write("sized.gltf", scene.text());
        const Outcome o =
            run("@sized.gltf -o @out.exr --method pt --iterations 1 --quiet --json "
                "@o.json " +
                options);
        EXPECT_EQ(o.exitCode, 0) << o.err;
        return {json("o.json")["width"], json("o.json")["height"]};
    };
    const nlohmann::json none, both{{"width", 64}, {"height", 16}}, wide{{"width", 24}},
        high{{"height", 10}};
    EXPECT_EQ(size(both, ""), Size(64, 16));
    EXPECT_EQ(size(both, "--width 20"), Size(20, 5));
    EXPECT_EQ(size(both, "--height 4"), Size(16, 4));
    EXPECT_EQ(size(both, "--width 20 --height 9"), Size(20, 9));
    EXPECT_EQ(size(both, "--width 1"), Size(1, 1));
    // If the extras name only one side, the camera's aspect of 1.5 gives the other.
    EXPECT_EQ(size(wide, ""), Size(24, 16));
    EXPECT_EQ(size(wide, "--width 12"), Size(12, 8));
    EXPECT_EQ(size(wide, "--height 10"), Size(15, 10));
    EXPECT_EQ(size(high, ""), Size(15, 10));
    EXPECT_EQ(size(high, "--width 12"), Size(12, 8));
    EXPECT_EQ(size(none, "--height 10"), Size(15, 10));
    EXPECT_EQ(size(none, "--width 12"), Size(12, 8));
}

/// Biased methods say so in the list, the help, stderr, the header and the JSON.
TEST_F(RenderOutput, BiasedMethodsSaySo) {
    std::size_t biased = 0;
    for (const MethodRow& row : methods()) {
        if (!row.biased) continue;
        ++biased;
        const Outcome o = run(quick(row.name, "--json @o.json --quiet"));
        ASSERT_EQ(o.exitCode, 0) << o.err;
        EXPECT_NE(o.err.find(row.name + " is BIASED"), std::string::npos) << o.err;
        EXPECT_NE(json("o.json")["warnings"].dump().find("BIASED"), std::string::npos);
        EXPECT_EQ(json("o.json")["biased"], true);
        EXPECT_TRUE(readExrLayers(path("out.exr")).attributes.contains("biased"));
        EXPECT_NE(run("--help-method " + row.name).out.find("biased"), std::string::npos);
        const std::string list = run("--list-methods").out;
        const std::size_t line = list.find(row.name + " ");
        ASSERT_NE(line, std::string::npos);
        EXPECT_NE(list.substr(line, list.find('\n', line) - line).find("biased"),
                  std::string::npos);
    }
    EXPECT_EQ(biased, 2u);
}

/// Rows and settings that merge say so too, and no others do.
TEST_F(RenderOutput, MethodsThatMergeSayThatTheyAreConsistentOnly) {
    const auto expectSaid = [&](const std::string& method, const std::string& more, bool merges) {
        const Outcome o = run(quick(method, "--json @o.json --quiet" + more));
        ASSERT_EQ(o.exitCode, 0) << o.err;
        EXPECT_EQ(json("o.json")["consistent"], merges) << method;
        const LayeredImage image = readExrLayers(path("out.exr"));
        ASSERT_EQ(image.attributes.contains("consistent"), merges) << method;
        if (!merges) return;
        EXPECT_EQ(attribute<std::string>(image, "consistent").find("not unbiased"), 0u);
    };
    const std::string list = run("--list-methods").out;
    std::size_t merging = 0;
    for (const MethodRow& row : methods()) {
        const bool merges = isConsistentOnly(row, resolve(row, {}));
        const std::string help = run("--help-method " + row.name).out;
        EXPECT_EQ(help.find("\nconsistent, not unbiased") != std::string::npos, merges) << row.name;
        const std::size_t line = list.find("\n" + row.name + " ") + 1;
        const std::string said = list.substr(line, list.find('\n', line) - line);
        EXPECT_EQ(said.find("consistent, not unbiased") != std::string::npos, merges) << said;
        if (merges) expectSaid(row.name, "", true);
        merging += merges;
    }
    EXPECT_EQ(merging, 2u);
    expectSaid("lvcbpt", "", false);
    expectSaid("lvcbpt", " --set merge=on", true);
}

TEST_F(RenderOutput, WithoutLightItIsBlackWithOneWarning) {
    TinyScene scene;
    scene.lamp = false;
    write("dark.gltf", scene.text());
    for (const MethodRow& row : methods()) {
        const Outcome o =
            run("@dark.gltf -o @out.exr --width 12 --height 8 --iterations 2 --method " + row.name +
                cheap(row.name));
        EXPECT_EQ(o.exitCode, 0) << o.err;
        // A biased row has a warning of its own.
        EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), row.biased ? 2 : 1) << o.err;
        EXPECT_NE(o.err.find("no light"), std::string::npos) << o.err;
        for (const Rgb& p : readImage(path("out.exr")).pixels) ASSERT_TRUE(isBlack(p));
    }
    // --quiet does not silence warnings.
    const Outcome quiet =
        run("@dark.gltf -o @out.exr --width 12 --height 8 --iterations 1 --method pt --quiet");
    EXPECT_EQ(std::count(quiet.err.begin(), quiet.err.end(), '\n'), 1) << quiet.err;
}

TEST_F(RenderOutput, AnEnvironmentFromTheCommandLine) {
    LayeredImage sky(8, 4);
    sky.setRgb("", Image(8, 4, Rgb(2.0f)));
    writeExr(path("sky.exr"), sky);
    // One edge: the sky seen directly past the room has exactly its radiance.
    ASSERT_EQ(run(quick("pt", "--quiet --env @sky.exr --env-scale 0.25 --max-depth 1")).exitCode,
              0);
    EXPECT_NEAR(readImage(path("out.exr")).at(0, 0).g, 0.5f, 1e-5f);
}

// 683 lumens per watt, for points, spots and suns only: the lamp of emissive triangles keeps its
// brightness.
TEST_F(RenderOutput, LampsInCandelaAreThoseInWatts) {
    TinyScene scene;
    scene.pointLight = true;
    write("watts.gltf", scene.text());
    scene.pointIntensity *= 683.0;
    write("candela.gltf", scene.text());
    const auto rendered = [&](const std::string& options) {
        const Outcome o =
            run("--method pt --width 24 --height 16 --iterations 4 --quiet -o "
                "@out.exr " +
                options);
        EXPECT_EQ(o.exitCode, 0) << o.err;
        return readImage(path("out.exr")).pixels;
    };
    const std::vector<Rgb> watts = rendered("@watts.gltf");
    EXPECT_EQ(rendered("@candela.gltf --units photometric"), watts);
    EXPECT_EQ(rendered("@watts.gltf --units radiometric"), watts);
    EXPECT_NE(rendered("@candela.gltf"), watts);
    expectFailure("@watts.gltf -o @out.exr --units lumens", 2,
                  "--units: expected radiometric or photometric, found 'lumens'");
}

TEST_F(RenderOutput, AnEnvironmentOfOneColour) {
    LayeredImage sky(1, 1);
    sky.setRgb("", Image(1, 1, Rgb(0.5f, 1.0f, 2.0f)));
    writeExr(path("sky.exr"), sky);
    ASSERT_EQ(run(quick("bpt", "--quiet --env @sky.exr")).exitCode, 0);
    const Image ofMap = readImage(path("out.exr"));
    ASSERT_EQ(run(quick("bpt", "--quiet --env-colour 0.5,1,2")).exitCode, 0);
    EXPECT_EQ(readImage(path("out.exr")).pixels, ofMap.pixels);
    // One edge: the environment seen directly past the room has exactly its radiance.
    ASSERT_EQ(run(quick("pt", "--quiet --env-colour 0.5,1,2 --max-depth 1")).exitCode, 0);
    EXPECT_NEAR(readImage(path("out.exr")).at(0, 0).b, 2.0f, 1e-5f);
}

}  // namespace
}  // namespace lacuna::test
