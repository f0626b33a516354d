// What a film says of its iterations: sums, and the spread that every z-test is as good as.
#include "libcore/bidir/film.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libcore/base/parallel.h"

namespace lacuna::test {
namespace {

/// Iterations of two pixels: 1, 2, 4 in red, thrice that in green, always the same in blue; the
/// second pixel is a hundred times the first.
Film threeIterations() {
    const ThreadPool threads(2);
    Film film(2, 1);
    for (const float v : {1.0f, 2.0f, 4.0f}) {
        const Rgb first{v, 3.0f * v, 5.0f};
        const Rgb pixels[] = {first, first * 100.0f};
        film.add(pixels, threads);
    }
    return film;
}

// 1, 2, 4: the mean is 7/3, the sum of squared deviations 14/3, so a sample's variance is 7/3 and
// that of the mean of three 7/9.
TEST(Film, varianceIsThatOfTheMean) {
    const Film film = threeIterations();
    const Image mean = film.image(), variance = film.variance();
    EXPECT_FLOAT_EQ(mean.at(0, 0).r, 7.0f / 3.0f);
    EXPECT_FLOAT_EQ(mean.at(1, 0).g, 700.0f);
    EXPECT_FLOAT_EQ(variance.at(0, 0).r, 7.0f / 9.0f);
    EXPECT_FLOAT_EQ(variance.at(0, 0).g, 7.0f);
    EXPECT_FLOAT_EQ(variance.at(1, 0).r, 70000.0f / 9.0f);
    EXPECT_EQ(variance.at(0, 0).b, 0.0f) << "no spread at all";
}

// The picture's mean is 50.5 times the first pixel, and so is its spread.
TEST(Film, meanColourHasTheErrorOfItsMean) {
    const Film::MeanColour m = threeIterations().meanColour();
    EXPECT_NEAR(m.mean[0], 50.5 * 7.0 / 3.0, 1e-9);
    EXPECT_NEAR(m.standardError[0], 50.5 * std::sqrt(7.0 / 9.0), 1e-9);
    EXPECT_NEAR(m.standardError[1], 3.0 * m.standardError[0], 1e-9);
    EXPECT_NEAR(m.standardError[2], 0.0, 1e-6);
}

TEST(Film, saysNothingOfASpreadThatItHasNotSeen) {
    const ThreadPool threads(1);
    Film film(1, 1);
    EXPECT_TRUE(isBlack(film.image().at(0, 0)));
    film.add(std::vector<Rgb>{Rgb(3.0f)}, threads);
    EXPECT_EQ(film.image().at(0, 0), Rgb(3.0f));
    EXPECT_EQ(film.variance().at(0, 0), Rgb(0.0f));
    EXPECT_EQ(film.meanColour().standardError[0], 0.0);
}

// Connections of the first eye vertex are half of the first pixel and nothing of the other.
TEST(TechniqueFilm, isAMeanOverIterationsAndKnowsTheShareOfFirstConnections) {
    TechniqueFilm film(2, 1, 3);
    film.countIteration();
    film.countIteration();
    film.add(1, 2, 0, Rgb(3.0f), Rgb(6.0f));
    film.add(0, 2, 0, Rgb(1.0f), Rgb(1.0f));  // a hit: no connection
    film.add(2, 1, 0, Rgb(2.0f), Rgb(2.0f));
    film.add(2, 1, 1, Rgb(2.0f), Rgb(2.0f));
    EXPECT_EQ(film.weighted(1, 2).at(0, 0), Rgb(1.5f));
    EXPECT_EQ(film.unweighted(1, 2).at(0, 0), Rgb(3.0f));
    LayeredImage image(2, 1);
    film.writeTo(image);
    EXPECT_FLOAT_EQ(image.channel("share.t02")[0], 0.5f);
    EXPECT_EQ(image.channel("share.t02")[1], 0.0f);
}

}  // namespace
}  // namespace lacuna::test
