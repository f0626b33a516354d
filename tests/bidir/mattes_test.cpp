// Coverage by name, against areas that are known.
#include "libcore/bidir/mattes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

/// A sheet of one unit per pixel, from x0 to x1 of a picture of 16 x 16 pixels.
void addSheet(SceneBuilder& b, float x0, float x1, float z, const std::string& name,
              std::uint32_t material) {
    const float s = (8 - z) / 8;  // so that it looks as large as at z = 0
    b.add(quad({(x0 - 8) * s, -20, z}, {(x1 - x0) * s, 0, 0}, {0, 40, 0}, material));
    if (name.empty()) return;
    b.d.instances.back().nodeName = std::uint32_t(b.d.nodeNames.size());
    b.d.nodeNames.push_back(name);
}

std::map<std::string, double> covers(const Matte& matte, std::size_t pixel) {
    std::map<std::string, double> shares;
    double last = 1;
    for (const Matte::Cover& cover : matte.pixels[pixel]) {
        EXPECT_LE(cover.share, last);  // in the order of ranks
        last = cover.share;
        if (cover.share > 0) shares[matte.names[cover.name]] = cover.share;
    }
    return shares;
}

TEST(Mattes, AreSharesOfThePixel) {
    SceneBuilder b;
    lacuna::Material red = matte(Rgb(0.5f)), veil = red, window = pane();
    red.name = "red";
    veil.name = "veil";
    veil.alphaMode = lacuna::Material::Alpha::Blend;
    veil.baseAlpha = 0.5f;
    const auto redOne = b.add(red), veilOne = b.add(veil);
    addSheet(b, 2.25f, 5, 0, "left", redOne);
    addSheet(b, 5, 7.5f, 0, "right", redOne);
    addSheet(b, 7.5f, 9, 0, "right", 0);  // the same object's name, no material's
    addSheet(b, 9, 12, 0, "", veilOne);
    addSheet(b, 11, 16, -1, "behind", redOne);
    addSheet(b, 3, 4, 1, "window", b.add(window));
    b.add(lookAt({0, 0, 8}, {0, 0, 0}, 90));
    const auto scene = b.build();
    const Camera camera = scene->makeCamera("", {16, 16}, {});
    const Mattes mattes = renderMattes(*scene, camera, {0, 16, 0, 16}, 1, pool());
    EXPECT_EQ(mattes.objects.names,
              (std::vector<std::string>{"behind", "left", "right", "unnamed", "window"}));
    EXPECT_EQ(mattes.materials.names, (std::vector<std::string>{"red", "unnamed", "veil"}));

    using Shares = std::map<std::string, double>;
    const std::size_t row = 8 * 16;
    EXPECT_EQ(covers(mattes.objects, row + 0), Shares{});
    EXPECT_NEAR(covers(mattes.objects, row + 2)["left"], 0.75, 1e-6);   // strata make it exact
    EXPECT_EQ(covers(mattes.objects, row + 3), (Shares{{"left", 1}}));  // through the window
    EXPECT_EQ(covers(mattes.objects, row + 7), (Shares{{"right", 1}}));
    EXPECT_NEAR(covers(mattes.materials, row + 7)["red"], 0.5, 1e-6);
    EXPECT_NEAR(covers(mattes.materials, row + 7)["unnamed"], 0.5, 1e-6);
    double veiled = 0, behind = 0;
    for (std::size_t y = 0; y < 16; ++y) {
        veiled += covers(mattes.objects, y * 16 + 11)["unnamed"] / 16;
        behind += covers(mattes.objects, y * 16 + 11)["behind"] / 16;
    }
    EXPECT_NEAR(veiled, 0.5, 0.08);
    EXPECT_NEAR(veiled + behind, 1, 1e-6);

    // A crop has the same covers as the whole.
    const Mattes part = renderMattes(*scene, camera, {9, 13, 4, 6}, 1, ThreadPool(1));
    for (std::size_t i = 0; i < part.objects.pixels.size(); ++i) {
        const std::size_t j = (4 + i / 4) * 16 + 9 + i % 4;
        EXPECT_EQ(covers(part.objects, i), covers(mattes.objects, j));
    }
}

TEST(Mattes, KeepWhatCoversMost) {
    SceneBuilder b;
    for (int i = 0; i < 8; ++i) {
        addSheet(b, float(i) * 2, float(i) * 2 + 2, 0, "strip " + std::to_string(i), 0);
    }
    b.add(lookAt({0, 0, 8}, {0, 0, 0}, 90));
    const auto scene = b.build();
    const Camera camera = scene->makeCamera("", {1, 1}, {});
    const Mattes mattes = renderMattes(*scene, camera, {0, 1, 0, 1}, 1, pool());
    const auto shares = covers(mattes.objects, 0);
    EXPECT_EQ(shares.size(), Matte::kRanks);
    for (const auto& [name, share] : shares) EXPECT_NEAR(share, 0.125, 1e-6);
}

}  // namespace
}  // namespace lacuna::test
