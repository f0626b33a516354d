// Output for compositors: alpha, ids, half floats and parts, as lacuna-render and lacuna-merge write them.
#include <stb/stb_image.h>

#include <algorithm>

#include "libcore/image/exr.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

class RenderCompositing : public RenderTool {
  protected:
    /// As quick(), but to a file of this name.
    std::string to(const std::string& name, const std::string& more) const {
        std::string text = quick("bpt", "--quiet --env-colour 0.2,0.4,0.8 " + more);
        return text.replace(text.find("out.exr"), 7, name);
    }
    LayeredImage made(const std::string& name, const std::string& more) {
        EXPECT_EQ(run(to(name, more)).exitCode, 0);
        return readExrLayers(path(name));
    }
};

// The upper left pixel sees past the room.
TEST_F(RenderCompositing, ABackgroundIsLeftOutWhereAlphaSaysSo) {
    const std::string common = "--iterations 4 --light-groups ";
    const LayeredImage shown = made("shown.exr", common);
    const LayeredImage image = made("a.exr", common + "--transparent-background");
    EXPECT_EQ(shown.find("A"), nullptr);
    const std::vector<float>& alpha = *image.find("A");
    EXPECT_EQ(alpha[0], 0.0f);
    EXPECT_EQ(image.rgb().pixels[0], Rgb());
    EXPECT_EQ(alpha[8 * 24 + 12], 1.0f);
    EXPECT_TRUE(std::ranges::any_of(alpha, [](float a) { return a > 0 && a < 1; }));
    const Image picture = image.rgb(), sky = image.rgb("light.environment");
    double ofSky = 0;
    for (std::size_t i = 0; i < alpha.size(); ++i) {
        EXPECT_NEAR(picture.pixels[i].b + 0.8f * (1 - alpha[i]), shown.rgb().pixels[i].b, 0.3f);
        ofSky += double(sky.pixels[i].b);
    }
    EXPECT_EQ(sky.pixels[0], Rgb());
    EXPECT_GT(ofSky, 0);  // the sky's light in the room stays
}

TEST_F(RenderCompositing, APngHasAlphaToo) {
    ASSERT_EQ(run(to("a.png", "--transparent-background --exposure 0")).exitCode, 0);
    int width = 0, height = 0, channels = 0;
    std::uint8_t* bytes = stbi_load(path("a.png").c_str(), &width, &height, &channels, 0);
    ASSERT_NE(bytes, nullptr);
    EXPECT_EQ(channels, 4);
    EXPECT_EQ(bytes[3], 0);
    EXPECT_EQ(bytes[4 * (8 * 24 + 12) + 3], 255);
    EXPECT_GT(bytes[4 * (8 * 24 + 12)], 0);
    stbi_image_free(bytes);
}

TEST_F(RenderCompositing, MergedPartsHaveTheAlphaAndIdsOfTheWhole) {
    const std::string common =
        "--iterations 4 --block-iterations 2 --transparent-background --cryptomatte object ";
    const LayeredImage whole = made("whole.exr", common);
    made("0.exr", common + "--blocks 0,1");
    made("1.exr", common + "--blocks 1,2");
    ASSERT_EQ(run("@1.exr @0.exr -o @merged.exr", LACUNA_MERGE).exitCode, 0);
    expectSamePicture("merged.exr", "whole.exr");
    EXPECT_TRUE(whole.attributes.contains("cryptomatte/3ae39a5/manifest"));

    // With half floats and parts, the merged file is what one render writes.
    made("half.exr", common + "--half --multi-part");
    ASSERT_EQ(run("@1.exr @0.exr -o @merged-half.exr --half --multi-part", LACUNA_MERGE).exitCode,
              0);
    expectSamePicture("merged-half.exr", "half.exr");
    made("half.exr", common + "--half");
    EXPECT_LT(std::filesystem::file_size(path("half.exr")),
              std::filesystem::file_size(path("whole.exr")));

    made("other.exr", "--iterations 4 --block-iterations 2 --blocks 1,2");
    expectFailure("@0.exr @other.exr -o @no.exr", 3, "background", LACUNA_MERGE);
}

TEST_F(RenderCompositing, ACheckpointGoesOnWithAlpha) {
    const std::string common = "--transparent-background --block-iterations 2 ";
    const LayeredImage whole = made("whole.exr", common + "--iterations 6");
    made("a.exr", common + "--iterations 4 --checkpoint @ck");
    made("a.exr", common + "--iterations 6 --checkpoint @ck");
    expectSamePicture("a.exr", "whole.exr");
    expectFailure(to("a.exr", "--block-iterations 2 --checkpoint @ck"), 3, "background");
}

TEST_F(RenderCompositing, IdsAreOfEveryRowAndOnlyWhereAskedFor) {
    const LayeredImage image = made("a.exr", "--cryptomatte object,material");
    for (const char* layer : {"CryptoObject00", "CryptoObject02", "CryptoMaterial01"}) {
        EXPECT_TRUE(image.hasRgb(layer)) << layer;
    }
    EXPECT_EQ(image.find("CryptoObject00.G")->at(0), 0.0f);
    EXPECT_EQ(image.find("CryptoObject00.G")->at(8 * 24 + 12), 1.0f);
    EXPECT_EQ(made("b.exr", "").find("CryptoObject00.R"), nullptr);
    EXPECT_FALSE(made("b.exr", "--cryptomatte material").hasRgb("CryptoObject00"));
}

TEST_F(RenderCompositing, WhatCannotBeWrittenIsRefused) {
    expectFailure(to("a.pfm", "--transparent-background"), 2,
                  "--transparent-background: expected an .exr or .png to hold alpha");
    expectFailure(to("a.png", "--cryptomatte object"), 2, "--cryptomatte: expected an .exr");
    for (const char* types : {"objects", "object,", "", "object material"}) {
        expectFailure(to("a.exr", std::string("--cryptomatte '") + types + "'"), 2,
                      "--cryptomatte");
    }
    for (const char* style : {"--half", "--multi-part"}) {
        expectFailure(to("a.png", style), 2, std::string(style) + ": expected an .exr");
        expectFailure(to("a.exr", std::string(style) + " --blocks 0,1"), 2,
                      "give it to lacuna-merge");
    }
    for (const char* name : {"rgba", "position", "CryptoObject"}) {
        expectFailure(to("a.exr", std::string("--layer ") + name + "=CL"), 2,
                      "a name that pictures do not use themselves");
    }
}

}  // namespace
}  // namespace lacuna::test
