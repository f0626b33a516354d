// The estimate of a picture's error, against the true error: iterations are drawn from distributions with known means,
// so that the truth is a sum over the pixels.
#include "libcore/bidir/error_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/bidir/film.h"
#include "libcore/bidir/sampler.h"
#include "libcore/image/error_metrics.h"

namespace lacuna::test {
namespace {

constexpr int kWidth = 96, kHeight = 64;

/// The features of one surface that fills the picture.
FeatureLayers even(int width, int height) {
    return {Image(width, height, Rgb(0.5f)), Image(width, height, Rgb(0.0f, 1.0f, 0.0f)), {}};
}

/// Draws a pixel's value in an iteration, with a mean of one.
using Draw = std::function<float(Rng&)>;

float normal(Rng& rng) {
    const float u = rng.uniform(), v = rng.uniform();
    return std::sqrt(-2.0f * std::log(1.0f - u)) * std::cos(6.2831853f * v);
}

/// Noise of standard deviation `sigma`, with a spike in one of 1 / p draws; spikes hold `share` of all light.
Draw noise(float sigma, float share = 0.0f, float p = 1.0f) {
    return [=](Rng& rng) {
        const float spike = rng.uniform() < p ? share / p : 0.0f;
        return 1.0f - share + sigma * normal(rng) + spike;
    };
}

struct Said {
    ErrorEstimate estimate;
    ErrorMeasures truth;
    double ratio() const { return truth.mape / estimate.mape.error; }
};

ErrorMeasures errorOf(const FilmSum& sum) {
    const ErrorReference reference(Image(kWidth, kHeight, Rgb(1.0f)));
    return reference.compare(sum.image(kWidth, kHeight));
}

/// The estimate and the truth after `iterations`. Each pixel is drawn by itself. `shared`, if there is one, adds a
/// number to each band of 32 columns of an iteration's pixels.
Said said(int iterations, std::uint64_t seed, const Draw& draw, const Draw& shared = {},
          BlockPlan plan = {}) {
    const ThreadPool threads(1);
    const ErrorMeter meter(even(kWidth, kHeight));
    Film film(kWidth, kHeight, plan);
    film.measure(meter);
    std::vector<Rgb> pixels(std::size_t(kWidth) * kHeight);
    for (int i = 0; i < iterations; ++i) {
        Rng rng(seed, std::uint32_t(i), StreamKind::User, 0);
        float band[kWidth / 32] = {};
        if (shared) std::ranges::generate(band, [&] { return shared(rng); });
        for (std::size_t p = 0; p < pixels.size(); ++p) {
            pixels[p] = Rgb(draw(rng) + band[p % kWidth / 32]);
        }
        film.add(pixels, threads);
    }
    const FilmSum sum = film.sum();
    return {estimateError(sum, meter, &threads), errorOf(sum)};
}

TEST(ErrorEstimate, meetsTheErrorOfNoise) {
    for (const int n : {32, 40, 64, 112}) {
        SCOPED_TRACE(n);
        const Said s = said(n, 1, noise(0.7f));
        EXPECT_EQ(s.estimate.mape.doubt, "");
        EXPECT_EQ(s.estimate.rmse.doubt, "");
        // The estimate stands above the truth by its margin and by 3 % for statistics.
        EXPECT_NEAR(s.ratio(), 0.94, 0.04);
        EXPECT_NEAR(s.truth.rmse / s.estimate.rmse.error, 0.94, 0.04);
        EXPECT_NEAR(s.truth.relmse / s.estimate.relmse.error, 0.93, 0.07);
    }
}

// Halves of a sequence differ by more than their mean is off. Here the integrand is an edge through the pixel, alone
// and beside noise that no numbers make even.
TEST(ErrorEstimate, meetsTheErrorOfEvenNumbers) {
    const ThreadPool threads(1);
    const ErrorMeter meter(even(kWidth, kHeight));
    for (const float independent : {0.0f, 0.1f}) {
        for (const int n : {64, 80, 128, 512}) {
            SCOPED_TRACE(std::to_string(independent) + " after " + std::to_string(n));
            const Sampler sampler(Sampling::Sobol, 7);
            Film film(kWidth, kHeight, {});
            film.measure(meter);
            std::vector<Rgb> pixels(std::size_t(kWidth) * kHeight);
            for (std::uint32_t i = 0; i < std::uint32_t(n); ++i) {
                for (std::size_t p = 0; p < pixels.size(); ++p) {
                    Rng rng = sampler.stream(i, StreamKind::EyePath, p);
                    const auto [u, v] = rng.evenPair();
                    pixels[p] = Rgb((u + v < 1.0f ? 1.5f : 0.5f) + independent * normal(rng));
                }
                film.add(pixels, threads);
            }
            const FilmSum sum = film.sum();
            const ErrorEstimate estimate = estimateError(sum, meter, &threads);
            EXPECT_EQ(estimate.mape.doubt, "");
            EXPECT_LT(errorOf(sum).mape / estimate.mape.error, 1.0);
            EXPECT_GT(errorOf(sum).mape / estimate.mape.error, 0.75) << "halves alone: 0.6";
        }
    }
}

// If a pixel has one spike or none, two halves show half of what spikes cost. Without the model the error would be
// twice the estimate.
TEST(ErrorEstimate, isNeverFarBelowTheErrorOfRareSpikes) {
    for (const float np : {0.05f, 0.2f, 0.5f, 1.0f, 2.5f, 5.0f, 20.0f}) {
        for (const float sigma : {0.1f, 1.0f}) {
            SCOPED_TRACE("np = " + std::to_string(np) + ", sigma = " + std::to_string(sigma));
            const Said s = said(64, 3, noise(sigma, 0.5f, np / 64.0f));
            EXPECT_EQ(s.estimate.mape.doubt, "");
            EXPECT_LT(s.ratio(), 1.1);
            EXPECT_GT(s.ratio(), 0.55);
        }
    }
}

// Each third of the picture shares one number, so that a single pair of halves may say anything.
TEST(ErrorEstimate, allowsForErrorsThatPixelsShare) {
    int above = 0;
    double ratios = 0.0;
    constexpr int kPictures = 40;
    for (int i = 0; i < kPictures; ++i) {
        const Said s = said(64, 100 + std::uint64_t(i), noise(0.2f),
                            [](Rng& rng) { return 0.3f * normal(rng); });
        above += s.ratio() > 1.1;
        ratios += s.ratio() / kPictures;
    }
    // 5 % of 40 are 2; more than 6 come by chance in one of 200.
    EXPECT_LE(above, 6);
    EXPECT_GT(ratios, 0.4) << "and not by saying far too much";
}

TEST(ErrorEstimate, saysNothingOfIterationsThatShareLightPaths) {
    const Said shared = said(64, 5, noise(0.5f), {}, {64, true});
    EXPECT_TRUE(std::isnan(shared.estimate.mape.error));
    EXPECT_NE(shared.estimate.mape.doubt, "");
    EXPECT_NE(shared.estimate.relmse.doubt, "");
    const Said blocks = said(256, 5, noise(0.5f), {}, {8, true});
    EXPECT_EQ(blocks.estimate.mape.doubt, "");
    EXPECT_NEAR(blocks.ratio(), 0.94, 0.06);
}

TEST(ErrorEstimate, doubtsWhereFewPixelsCarryTheError) {
    // About one spike in the whole picture: it has a hundredth of the light, but most of its square.
    const Said s = said(64, 7, noise(0.01f, 0.01f, 3e-6f));
    EXPECT_NE(s.estimate.relmse.doubt, "");
    EXPECT_NE(s.estimate.rmse.doubt, "");
}

TEST(ErrorEstimate, ofBlackAndOfOnePixel) {
    const ThreadPool threads(1);
    for (const float value : {0.0f, 1.0f}) {
        const ErrorMeter meter(even(1, 1));
        Film film(1, 1);
        film.measure(meter);
        EXPECT_NE(estimateError(film.sum(), meter, nullptr).mape.doubt, "");
        for (int i = 0; i < 64; ++i) {
            film.add(std::vector<Rgb>{Rgb(value * float(i % 5))}, threads);
        }
        const ErrorEstimate e = estimateError(film.sum(), meter, nullptr);
        EXPECT_NE(e.mape.doubt, "");
        EXPECT_TRUE(std::isfinite(e.mape.error));
        EXPECT_EQ(e.rmse.error > 0.0, value > 0.0f);
    }
}

TEST(ErrorEstimate, isTheSameHoweverTheSumsCameAbout) {
    const ThreadPool one(1), two(2);
    const ErrorMeter meter(even(200, 150));
    const auto pixels = [](std::uint64_t i) {
        Rng rng(11, std::uint32_t(i), StreamKind::User, 0);
        std::vector<Rgb> p(200 * 150);
        for (Rgb& c : p) c = Rgb(rng.uniform(), 10.0f * rng.uniform(), 0.1f);
        return p;
    };
    for (const std::uint64_t size : {8u, 5u, 64u}) {
        const BlockPlan plan{size, false};
        Film whole(200, 150, plan);
        whole.measure(meter);
        for (std::uint64_t i = 0; i < 40; ++i) whole.add(pixels(i), one);
        for (const bool withOpen : {false, true}) {
            Film first(200, 150, plan), second(200, 150, plan);
            first.measure(meter);
            second.measure(meter);
            for (std::uint64_t i = 0; i < 21; ++i) first.add(pixels(i), two);
            second.restore(first.state(withOpen), two);
            while (second.nextIteration() < 40) second.add(pixels(second.nextIteration()), two);
            EXPECT_EQ(second.sum().differences, whole.sum().differences);
            EXPECT_FALSE(whole.sum().differences.empty());
            EXPECT_EQ(estimateError(second.sum(), meter, &two).relmse.error,
                      estimateError(whole.sum(), meter, nullptr).relmse.error);
        }
    }
}

TEST(ErrorEstimate, isMadeAtSetTimes) {
    std::vector<std::uint64_t> times;
    for (std::uint64_t n = 0; n < 100; ++n) {
        if (isMeasured(n)) times.push_back(n);
    }
    EXPECT_EQ(times, (std::vector<std::uint64_t>{4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40,
                                                 48, 56, 64, 80, 96}));
}

/// The window does not look at pixels of another surface: beside a lamp of 100 the wall's error is relative to the
/// wall.
TEST(ErrorEstimate, looksAtPixelsThatShowTheSame) {
    const ThreadPool threads(1);
    FeatureLayers features = even(64, 64);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; x += 2) features.albedo.at(x, y) = Rgb(0.1f);
    }
    const auto error = [&](const FeatureLayers& layers) {
        const ErrorMeter meter(layers);
        Film film(64, 64);
        film.measure(meter);
        for (int i = 0; i < 64; ++i) {
            Rng rng(13, std::uint32_t(i), StreamKind::User, 0);
            std::vector<Rgb> p(64 * 64);
            for (std::size_t k = 0; k < p.size(); ++k) {
                p[k] = Rgb((k % 2 ? 100.0f : 1.0f) * (0.5f + rng.uniform()));
            }
            film.add(p, threads);
        }
        return estimateError(film.sum(), meter, nullptr).mape.error;
    };
    EXPECT_LT(error(features), 0.9 * error(even(64, 64)));
}

}  // namespace
}  // namespace lacuna::test
