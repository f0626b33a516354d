// Small pictures that are rendered before the one that was asked for.
#include "libcore/bidir/small_film.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libcore/base/rng.h"

namespace lacuna::test {
namespace {

TEST(SmallFilm, isTheFilmWhereThatIsSmallEnough) {
    const Camera::Film whole{64, 36};
    const PixelRect crop{3, 40, 5, 36};
    const SmallFilm small(whole, crop, 37 * 31);
    EXPECT_EQ(small.film.width, 64);
    EXPECT_EQ(small.film.height, 36);
    EXPECT_EQ(small.crop, crop);
    EXPECT_EQ(small.scale, 1);
}

TEST(SmallFilm, ofTheWholeFilmHasItsShape) {
    const SmallFilm small({1920, 1080}, 4096);
    EXPECT_EQ(small.crop, (PixelRect{0, small.film.width, 0, small.film.height}));
    EXPECT_NEAR(pixelsOf(small.film), 4096, 0.03 * 4096);
    EXPECT_NEAR(double(small.film.width) / double(small.film.height), 16.0 / 9, 0.03);
    EXPECT_NEAR(small.scale, 1920.0 * 1080 / 4096, 0.03 * small.scale);
}

TEST(SmallFilm, hasAPartOfTheCropAtLeast) {
    Rng rng(1, 0, StreamKind::User, 0);
    const auto below = [&](int n) { return int(rng.below(std::uint32_t(n))); };
    for (int i = 0; i < 2000; ++i) {
        const Camera::Film whole{1 + below(3000), 1 + below(3000)};
        PixelRect crop{below(whole.width), 0, below(whole.height), 0};
        crop.x1 = crop.x0 + 1 + below(whole.width - crop.x0);
        crop.y1 = crop.y0 + 1 + below(whole.height - crop.y0);
        const SmallFilm small(whole, crop, double(1 + below(10000)));
        EXPECT_LE(small.film.width, whole.width);
        EXPECT_LE(small.film.height, whole.height);
        EXPECT_GE(small.crop.x0, 0);
        EXPECT_GE(small.crop.y0, 0);
        EXPECT_GE(small.crop.width(), 1);
        EXPECT_GE(small.crop.height(), 1);
        EXPECT_LE(small.crop.x1, small.film.width);
        EXPECT_LE(small.crop.y1, small.film.height);
        const double area = double(crop.width()) * crop.height();
        EXPECT_DOUBLE_EQ(small.scale * small.crop.width() * small.crop.height(), area);
    }
}

}  // namespace
}  // namespace lacuna::test
