// The pixel filter is a box of one pixel: denoisers would take noise that pixels share for the picture.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"

namespace lacuna::test {
namespace {

class PixelFilter : public RowTest {};
INSTANTIATE_TEST_SUITE_P(All, PixelFilter, testing::Values("pt", "lt", "bpt"), ByParameter());

/// All that a path brings, also by a splat, is in the one pixel that its edge at the lens passes through.
TEST_P(PixelFilter, keepsEachPathInItsPixel) {
    const auto scene = glossyBox().builder.build();
    Shot shot = quickShot(1);
    const Camera camera = scene->makeCamera("", {shot.width, shot.height}, {});
    std::vector<Vec3d> sums(std::size_t(shot.width * shot.height));
    int splats = 0;
    shot.observer = [&](const PathEvent& event) {
        const Rgb& c = event.contribution;
        sums[event.pixel] += Vec3d{c.r, c.g, c.b};
        const PathVertex &lens = *event.path.vertex[std::size_t(event.path.edges)],
                         &seen = *event.path.vertex[std::size_t(event.path.edges) - 1];
        const auto at = camera.project(lens.position, normalize(seen.position - lens.position));
        ASSERT_TRUE(at);
        const int x = int(event.pixel) % shot.width, y = int(event.pixel) / shot.width;
        EXPECT_NEAR(at->raster.x, float(x) + 0.5f, 0.501f);
        EXPECT_NEAR(at->raster.y, float(y) + 0.5f, 0.501f);
        splats += event.technique.t == 1;
    };
    const Image image = render(*scene, row(), shot).pixels.image();
    EXPECT_EQ(splats > 0, GetParam() != "pt");
    for (std::size_t i = 0; i < sums.size(); ++i) {
        EXPECT_NEAR(image.pixels[i].g, sums[i].y, 1e-5 * (1 + sums[i].y)) << i;
    }
}

}  // namespace
}  // namespace lacuna::test
