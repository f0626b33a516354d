#include "libcore/image/sheet.h"

#include <set>

#include "libcore/image/cryptomatte.h"
#include "tests/image/test_files.h"

namespace lacuna {
namespace {

using Colours = std::set<Colour8>;

Colours coloursOf(const Canvas& canvas) {
    Colours colours;
    const std::vector<std::uint8_t>& b = canvas.bytes();
    for (std::size_t i = 0; i < b.size(); i += 3) colours.insert({b[i], b[i + 1], b[i + 2]});
    return colours;
}

TEST(Canvas, drawsInsideAndLeavesOutTheRest) {
    Canvas canvas(60, 40, {1, 2, 3});
    canvas.fill(-5, -5, 8, 8, {9, 9, 9});
    canvas.fill(50, 30, 100, 100, {9, 9, 9});
    canvas.write(50, 0, "wide text", {200, 0, 0});
    EXPECT_EQ(canvas.bytes().size(), 60u * 40u * 3u);
    EXPECT_EQ(canvas.bytes()[0], 9);
    EXPECT_EQ(canvas.bytes()[3 * 3], 1);
    EXPECT_EQ(coloursOf(canvas), (Colours{{1, 2, 3}, {9, 9, 9}, {200, 0, 0}}));
}

TEST(Canvas, textsOfAnyBytesFit) {
    EXPECT_EQ(fitted("short", 500), "short");
    const std::string part = fitted("weighted.s02t03.of.something.long", 120);
    EXPECT_TRUE(part.ends_with(".."));
    EXPECT_LE(Canvas::widthOf(part), 120);
    EXPECT_EQ(Canvas::widthOf("\xc3\xa4"), Canvas::widthOf("?"));  // one character, two bytes
    EXPECT_GT(Canvas::widthOf("Wand"), Canvas::widthOf("."));
}

/// Each kind of layer is shown in its own way, and none is left out.
TEST(LayerSheet, showsEveryLayer) {
    LayeredImage image(40, 30);
    image.setRgb("", Image(40, 30, Rgb(0.5f, 0.25f, 0.125f)));
    const Canvas alone = layerSheet(image, {});
    const auto area = [](const Canvas& c) { return c.width() * c.height(); };
    image.setRgb("variance", Image(40, 30, Rgb(1e4f)));            // beyond the scale: pale yellow
    image.setRgb("albedo", Image(40, 30, Rgb(1.0f, 0.0f, 0.0f)));  // whatever the exposure
    for (const char* axis : {"X", "Y", "Z"}) {
        image.channel(std::string("normal.") + axis).assign(1200, axis[0] == 'Z' ? 1.0f : 0.0f);
    }
    image.channel("Z").assign(1200, 3.0f);
    image.setRgb("light.lamp", Image(40, 30, Rgb(0.0f, 0.0f, 0.25f)));
    for (const char* axis : {"X", "Y", "Z"}) {
        image.channel(std::string("position.") + axis).assign(1200, 2.0f);
    }
    image.channel("A").assign(1200, 0.5f);
    Matte matte{"CryptoObject", {"bunny"}, std::vector<Matte::Pixel>(1200)};
    for (Matte::Pixel& pixel : matte.pixels) pixel[0] = {0, 1.0f};
    addCryptomatte(image, matte);
    const Canvas all = layerSheet(image, {.exposure = 1.0});
    EXPECT_GE(area(all), 8 * area(alone));
    const Colours colours = coloursOf(all);
    for (const Colour8& expected :
         {Colour8{255, 188, 137},  // the picture, one stop up
          Colour8{255, 250, 190}, Colour8{255, 0, 0}, Colour8{128, 128, 255},
          Colour8{0, 0, 188},         // the lamp, one stop up
          Colour8{188, 188, 188}}) {  // alpha
        EXPECT_TRUE(colours.count(expected))
            << int(expected[0]) << " " << int(expected[1]) << " " << int(expected[2]);
    }
    EXPECT_THROW(layerSheet(LayeredImage(2, 2), {}), std::invalid_argument);
}

TEST(LayerSheet, picturesOfAnyShapeFit) {
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(5000, 1), std::pair(1, 5000)}) {
        LayeredImage image(width, height);
        image.setRgb("", Image(width, height, Rgb(1)));
        const Canvas canvas = layerSheet(image, {});
        EXPECT_LE(canvas.width(), 500) << width;
        EXPECT_LE(canvas.height(), 500) << width;
    }
}

}  // namespace
}  // namespace lacuna
