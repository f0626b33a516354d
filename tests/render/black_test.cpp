// Pictures that are black although the scene has lights: lacuna-render names the cause, and says nothing of pictures
// with light.
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

using Json = nlohmann::json;

// The quads of TinyScene. Meshes and nodes have the same order.
enum Quad : std::size_t { Floor, Ceiling, Back, Left, Right, Lamp, Quads };

class RenderBlack : public RenderTool {
  protected:
    /// Renders the scene after `edit` and returns the one warning, or "".
    std::string warningOf(const TinyScene& scene, const std::function<void(Json&)>& edit,
                          const std::string& options) const {
        Json root = Json::parse(scene.text());
        edit(root);
        write("scene.gltf", root.dump());
        const Outcome o =
            run("@scene.gltf -o @out.exr --width 24 --height 16 --iterations 4 "
                "--quiet --json @o.json " +
                options);
        EXPECT_EQ(o.exitCode, 0) << o.err;
        EXPECT_LE(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
        const Json warnings = Json::parse(read("o.json")).at("warnings");
        EXPECT_EQ(warnings.size(), o.err.empty() ? 0u : 1u);
        for (const Json& warning : warnings) {
            EXPECT_NE(o.err.find(warning.get<std::string>()), std::string::npos) << o.err;
        }
        return o.err;
    }
    bool isPictureBlack() const {
        for (const Rgb& p : readImage(path("out.exr")).pixels) {
            if (!isBlack(p)) return false;
        }
        return true;
    }
    /// Expects a black picture and a warning with this part and no other cause.
    void expectCause(const std::string& part, const TinyScene& scene,
                     const std::function<void(Json&)>& edit, const std::string& options) const {
        const std::string warning = warningOf(scene, edit, options);
        EXPECT_TRUE(isPictureBlack());
        EXPECT_NE(warning.find("every pixel is black: "), std::string::npos) << warning;
        EXPECT_NE(warning.find(part), std::string::npos) << warning;
        EXPECT_NE(warning.find("'Why is my picture black?' in render/README.md"), std::string::npos)
            << warning;
        for (const char* other :
             {"black, which is no light", "joins surfaces with the camera alone", "finds few ways",
              "found no light; a test", "raise --max-depth", "sees no surface",
              "no light meets a surface", "seen from behind", "more than six in a row",
              "is the light shut in?"}) {
            if (part.find(other) != std::string::npos) continue;
            EXPECT_EQ(warning.find(other), std::string::npos) << warning;
        }
    }
};

/// Keeps these quads and all nodes after the quads (camera, point light) in the scene.
void keep(Json& root, const std::vector<std::size_t>& quads) {
    Json nodes = Json::array();
    for (const std::size_t q : quads) nodes.push_back(q);
    for (std::size_t n = Quads; n < root["nodes"].size(); ++n) nodes.push_back(n);
    root["scenes"][0]["nodes"] = nodes;
}

void makeMirrors(Json& root) {
    for (std::size_t m = 0; m < 4; ++m) {
        root["materials"][m]["pbrMetallicRoughness"] = {{"metallicFactor", 1},
                                                        {"roughnessFactor", 0}};
    }
}

TinyScene withPoint() {
    TinyScene scene;
    scene.lamp = false;
    scene.pointLight = true;
    return scene;
}

const auto kAsItIs = [](Json&) {};

TEST_F(RenderBlack, PicturesWithLightSayNothing) {
    for (const char* method : {"pt", "lt", "bpt"}) {
        EXPECT_EQ(warningOf({}, kAsItIs, std::string("--method ") + method), "");
        EXPECT_FALSE(isPictureBlack());
    }
}

TEST_F(RenderBlack, WithoutLightThatAloneIsSaid) {
    TinyScene dark;
    dark.lamp = false;
    const std::string warning = warningOf(dark, kAsItIs, "--method pt");
    EXPECT_NE(warning.find("no light in the scene"), std::string::npos) << warning;
    EXPECT_EQ(warning.find("every pixel"), std::string::npos) << warning;
}

TEST_F(RenderBlack, EmissionOfBlackIsNoLight) {
    const std::vector<std::uint8_t> black(3, 0);
    writePngBytes(path("black.png"), 1, 1, black);
    const auto edit = [](Json& root) {
        root["images"] = Json::array({{{"uri", "black.png"}}});
        root["textures"] = Json::array({{{"source", 0}}});
        root["materials"][4]["emissiveTexture"] = {{"index", 0}};
    };
    expectCause("the emission of every lamp is black, which is no light", {}, edit, "--method bpt");
}

TEST_F(RenderBlack, LampsThatFaceAway) {
    const auto edit = [](Json& root) {
        keep(root, {Floor, Lamp});
        root["nodes"][Lamp]["rotation"] = {1, 0, 0, 0};
        root["nodes"][Lamp]["translation"] = {0, 1.96, 0};
    };
    for (const char* method : {"pt", "bpt", "lvcbpt --set candidates=100"}) {
        const std::string options = std::string("--method ") + method;
        const std::string warning = warningOf({}, edit, options);
        EXPECT_TRUE(isPictureBlack());
        EXPECT_NE(warning.find("no light meets a surface: do the lamps face away?"),
                  std::string::npos)
            << warning;
        EXPECT_NE(warning.find("seen from behind"), std::string::npos) << warning;
    }
    // From both sides, the lamp is bright.
    const auto both = [&](Json& root) {
        edit(root);
        root["materials"][4]["doubleSided"] = true;
    };
    EXPECT_EQ(warningOf({}, both, "--method pt"), "");
}

TEST_F(RenderBlack, TooShortPaths) {
    expectCause(
        "no light was found on paths of up to 1 edge, a test with 12 found some: raise "
        "--max-depth",
        withPoint(), kAsItIs, "--method bpt --max-depth 1");
    EXPECT_EQ(warningOf(withPoint(), kAsItIs, "--method bpt --max-depth 2"), "");
}

TEST_F(RenderBlack, LightTracingAndMirrors) {
    // The lamp, behind the camera, shines at mirrors.
    const auto edit = [](Json& root) {
        makeMirrors(root);
        keep(root, {Back, Lamp});
        root["nodes"][Lamp]["rotation"] = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
        root["nodes"][Lamp]["translation"] = {0, 0, 4};
    };
    expectCause("lt joins surfaces with the camera alone", {}, edit, "--method lt");
    EXPECT_EQ(warningOf({}, edit, "--method pt"), "");
}

TEST_F(RenderBlack, PointLightBehindSmoothGlass) {
    // The light is above a ceiling of solid glass and sheets of glass over it. (Shadow rays would pass a thin pane.)
    int sheets = 0;
    const auto edit = [&](Json& root) {
        keep(root, {Floor, Ceiling});
        root["materials"].push_back(
            {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
             {"extensions",
              {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
               {"KHR_materials_volume", {{"thicknessFactor", 1}}}}}});
        for (const char* name : {"transmission", "volume"}) {
            root["extensionsUsed"].push_back(std::string("KHR_materials_") + name);
        }
        root["meshes"][Ceiling]["primitives"][0]["material"] = 5;
        root["nodes"].back()["translation"] = {0, 1.2, 0};
        for (int i = 0; i < sheets; ++i) {
            root["scenes"][0]["nodes"].push_back(root["nodes"].size());
            root["nodes"].push_back({{"mesh", Ceiling}, {"translation", {0, 0.02 * (i + 1), 0}}});
        }
    };
    EXPECT_EQ(warningOf(withPoint(), edit, "--method pt"), "");
    EXPECT_EQ(warningOf(withPoint(), edit, "--method bpt"), "");
    sheets = 6;  // a chain has six vertices at most
    expectCause("finds few ways", withPoint(), edit, "--method pt");
}

TEST_F(RenderBlack, PointLightsAndMirrorsAlone) {
    for (const char* method : {"pt", "bpt"}) {
        expectCause("more than six in a row", withPoint(), makeMirrors,
                    std::string("--method ") + method);
    }
}

TEST_F(RenderBlack, ACameraThatLooksAway) {
    const auto edit = [](Json& root) {
        root["nodes"][Quads]["rotation"] = {0, 1, 0, 0};  // the camera
    };
    expectCause("the camera sees no surface", {}, edit, "--method bpt");
}

TEST_F(RenderBlack, NothingIsNamedThatWasNotFound) {
    // Black walls: light and camera reach surfaces, and no other cause can be named.
    const auto edit = [](Json& root) {
        keep(root, {Back, Lamp});
        root["materials"][2] = root["materials"][4];
        root["materials"][2].erase("emissiveFactor");
        root["nodes"][Lamp]["rotation"] = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
        root["nodes"][Lamp]["translation"] = {0, 0, 4};
    };
    expectCause("is the light shut in?", {}, edit, "--method pt");
}

/// The causes for a dark crop are those of the crop, not of the room.
TEST_F(RenderBlack, CropsAreLookedAtAlone) {
    const Outcome o = run(
        "@room.gltf -o @out.exr --width 240 --height 160 --crop 0,8,0,8 --method pt --iterations 2 "
        "--quiet");
    EXPECT_EQ(o.exitCode, 0);
    EXPECT_NE(o.err.find("the camera sees no surface"), std::string::npos) << o.err;
}

}  // namespace
}  // namespace lacuna::test
