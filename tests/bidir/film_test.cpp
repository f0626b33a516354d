// What a film says of its iterations: sums, and the spread on which every z-test depends.
#include "libcore/bidir/technique_film.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/bidir/light_noise.h"
#include "libcore/bidir/technique_clock.h"

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
    const FilmSum::MeanColour m = threeIterations().meanColour();
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

// Blocks ------------------------------------------------------------------------------------------

constexpr int kPixels = 3;

std::vector<Rgb> iterationPixels(std::uint64_t number) {
    Rng rng(9, std::uint32_t(number), StreamKind::User, 0);
    std::vector<Rgb> pixels(kPixels);
    // Over many orders of magnitude, so that any other order of summation would show.
    const auto value = [&] { return std::pow(10.0f, 8.0f * rng.uniform() - 4.0f); };
    for (Rgb& p : pixels) p = {value(), value(), 0.25f};
    return pixels;
}

Film filmOf(std::uint64_t begin, std::uint64_t end, BlockPlan plan, std::uint64_t firstBlock = 0) {
    const ThreadPool threads(1);
    Film film(kPixels, 1, plan, firstBlock);
    for (std::uint64_t i = begin; i < end; ++i) film.add(iterationPixels(i), threads);
    return film;
}

void expectSameSum(const FilmSum& a, const FilmSum& b) {
    EXPECT_EQ(a.iterations, b.iterations);
    EXPECT_EQ(a.samples, b.samples);
    EXPECT_EQ(a.mean, b.mean);
    EXPECT_EQ(a.spread, b.spread);
    EXPECT_EQ(a.wholeMean, b.wholeMean);
    EXPECT_EQ(a.wholeSquares, b.wholeSquares);
}

TEST(Film, anyPieceOfAPictureGoesOnToTheSameSums) {
    const ThreadPool threads(1);
    constexpr std::uint64_t kEnd = 103;
    for (const std::uint64_t size : {1u, 5u, 8u, 64u}) {
        for (const BlockPlan plan :
             {BlockPlan{size, false}, BlockPlan{size, true}, BlockPlan{size, false, 4}}) {
            const FilmSum whole = filmOf(0, kEnd, plan).sum();
            for (const std::uint64_t stop : {1u, 4u, 37u, 64u, 102u}) {
                SCOPED_TRACE(std::to_string(size) + " to a block, stopped at " +
                             std::to_string(stop));
                const Film before = filmOf(0, stop, plan);
                for (const bool withOpen : {false, true}) {
                    Film after(kPixels, 1, plan);
                    after.restore(before.state(withOpen), threads);
                    EXPECT_EQ(after.nextIteration(), withOpen ? stop : stop / size * size);
                    while (after.nextIteration() < kEnd) {
                        after.add(iterationPixels(after.nextIteration()), threads);
                    }
                    expectSameSum(after.sum(), whole);
                }
            }
        }
    }
}

TEST(Film, aSnapshotStaysAsItWas) {
    const ThreadPool threads(1);
    Film film = filmOf(0, 6, {4, false});
    const Film::State snapshot = film.state(true);
    for (std::uint64_t i = 6; i < 40; ++i) film.add(iterationPixels(i), threads);
    Film before(kPixels, 1, {4, false});
    before.restore(snapshot, threads);
    expectSameSum(before.sum(), filmOf(0, 6, {4, false}).sum());
}

TEST(SumTree, neighboursJoinToTheSumOfBoth) {
    const ThreadPool threads(1);
    const BlockPlan plan{3, false};
    const FilmSum whole = filmOf(0, 13 * 3, plan).sum();
    for (const std::uint64_t a : {1u, 4u, 5u}) {
        for (const std::uint64_t b : {6u, 8u, 11u}) {
            SumTree tree(1);
            for (const auto& [begin, end] : {std::pair{std::uint64_t(0), a}, {a, b}, {b, 13ul}}) {
                const Film part = filmOf(begin * 3, end * 3, plan, begin);
                for (const SumTree::Node& node : part.state(false).blocks) tree.add(node, &threads);
            }
            FilmSum sum;
            tree.addTo(sum, nullptr);
            expectSameSum(sum, whole);
        }
    }
}

// Two blocks of 1, 2 and 4, 9: their means are 1.5 and 6.5, so the mean of both has the variance
// (2.5^2 + 2.5^2) / 2, whatever their iterations did.
TEST(Film, whereIterationsShareLightPathsBlocksAreTheSamples) {
    const ThreadPool threads(1);
    Film film(1, 1, {2, true});
    for (const float v : {1.0f, 2.0f, 4.0f, 9.0f}) {
        EXPECT_EQ(film.sum().samples, (film.iterations() + 1) / 2);
        film.add(std::vector<Rgb>{Rgb(v)}, threads);
    }
    EXPECT_FLOAT_EQ(film.image().at(0, 0).r, 4.0f);
    EXPECT_FLOAT_EQ(film.variance().at(0, 0).r, 6.25f);
    EXPECT_NEAR(film.meanColour().standardError[0], 2.5, 1e-12);
    EXPECT_EQ(filmOf(0, 2, {2, true}).variance().at(0, 0).r, 0.0f) << "one block has no spread";
}

// Groups of two, of which the last may be under way: 1.5 and 6.5 as above, then 4.
TEST(Film, whereNumbersAreEvenGroupsAreTheSamples) {
    const ThreadPool threads(1);
    const BlockPlan plan{64, false, 2};
    Film film(1, 1, plan);
    for (const float v : {1.0f, 2.0f, 4.0f, 9.0f}) film.add(std::vector<Rgb>{Rgb(v)}, threads);
    EXPECT_EQ(film.sum().samples, 2u);
    EXPECT_FLOAT_EQ(film.variance().at(0, 0).r, 6.25f);
    film.add(std::vector<Rgb>{Rgb(4.0f)}, threads);
    EXPECT_EQ(film.sum().samples, 3u);
    EXPECT_FLOAT_EQ(film.image().at(0, 0).r, 4.0f);
    EXPECT_FLOAT_EQ(film.variance().at(0, 0).r, 2 * (2.5f * 2.5f + 2.5f * 2.5f) / (5 * 2));
    // A group ends with its block.
    Film blocks(1, 1, {3, false, 2});
    for (int i = 0; i < 7; ++i) blocks.add(std::vector<Rgb>{Rgb(1.0f)}, threads);
    EXPECT_EQ(blocks.sum().samples, 5u);
}

// A single group: 1, 2, 4 spread about 7/3 as if they were independent. With a second group this is forgotten.
// Iterations that share light paths may be closer than that, so that nothing is said.
TEST(Film, aSingleGroupTellsByItsIterations) {
    const ThreadPool threads(1);
    const auto filmOf = [&](BlockPlan plan, std::initializer_list<float> values) {
        Film film(1, 1, plan);
        for (const float v : values) film.add(std::vector<Rgb>{Rgb(v)}, threads);
        return film;
    };
    const BlockPlan even{64, false, 4};
    const Film one = filmOf(even, {1.0f, 2.0f, 4.0f});
    EXPECT_EQ(one.sum().samples, 1u);
    EXPECT_NEAR(one.variance().at(0, 0).r, 7.0 / 3.0 / 3.0, 1e-6);
    EXPECT_NEAR(one.meanColour().standardError[0], std::sqrt(7.0) / 3.0, 1e-6);
    EXPECT_EQ(filmOf(even, {1.0f}).variance().at(0, 0).r, 0.0f);
    // 2.5 four times and 5: weights 4 and 1 about 3.
    const Film two = filmOf(even, {1.0f, 2.0f, 4.0f, 3.0f, 5.0f});
    EXPECT_EQ(two.sum().samples, 2u);
    EXPECT_NEAR(two.variance().at(0, 0).r, (4 * 0.25 + 4.0) / 5.0, 1e-6);
    EXPECT_EQ(filmOf({64, true}, {1.0f, 2.0f, 4.0f}).variance().at(0, 0).r, 0.0f);
}

class OneLayer final : public BlockLayers {
  public:
    Layers means() const override { return value != 0.0f ? Layers{{"a.R", {value}}} : Layers{}; }
    void clear() override { value = 0.0f; }
    float value = 0.0f;
};

TEST(Film, layersAreMeansOverAllBlocks) {
    const ThreadPool threads(1);
    Film film(1, 1, {2, false});
    OneLayer layer;
    film.addLayers(layer);
    const std::vector<Rgb> pixel{Rgb(1.0f)};
    layer.value = 3.0f;
    film.add(pixel, threads);
    film.add(pixel, threads);
    EXPECT_EQ(layer.value, 0.0f) << "cleared at the end of its block";
    film.add(pixel, threads);  // nothing in this block
    film.add(pixel, threads);
    layer.value = 6.0f;
    film.add(pixel, threads);
    EXPECT_FLOAT_EQ(film.sum().layers.at("a.R")[0], (2 * 3.0f + 2 * 0.0f + 6.0f) / 5);
    EXPECT_TRUE(film.state(true).open[0].sum->layers.empty());
    EXPECT_FLOAT_EQ(film.finalState(threads).open[0].sum->layers.at("a.R")[0], 6.0f);
}

// Sums in floats would overflow, and so would squares.
TEST(Film, holdsThePowersThatAFloatHolds) {
    const ThreadPool threads(1);
    for (const float unit : {1e-37f, 1e37f}) {
        Film film(1, 1, {4, false});
        for (int i = 0; i < 100; ++i)
            film.add(std::vector<Rgb>{Rgb(unit * float(i % 3 + 1))}, threads);
        EXPECT_FLOAT_EQ(film.image().at(0, 0).r, unit * 1.99f);
        EXPECT_NEAR(film.meanColour().standardError[0] / double(unit), 0.0820, 1e-3);
    }
}

// A day's render: sums in floats would stop growing long before its end. Red is one and noise, green is rare, blue
// never changes.
TEST(Film, aMillionIterationsAreSummedAsTheFirstOnes) {
    const ThreadPool threads(1);
    constexpr int kIterations = 1'000'000;
    Film film(1, 1, {64, false});
    Rng rng(33, 0, StreamKind::User, 0);
    double sum[2] = {0, 0}, squares[2] = {0, 0};
    for (int i = 0; i < kIterations; ++i) {
        const float value[2] = {1.0f + rng.uniform(), rng.below(10'000) ? 0.0f : 1000.0f};
        for (int c = 0; c < 2; ++c) {
            sum[c] += double(value[c]);
            squares[c] += double(value[c]) * double(value[c]);
        }
        film.add(std::vector<Rgb>{{value[0], value[1], 0.1f}}, threads);
    }
    const Rgb mean = film.image().at(0, 0), variance = film.variance().at(0, 0);
    const float means[] = {mean.r, mean.g}, variances[] = {variance.r, variance.g};
    for (int c = 0; c < 2; ++c) {
        const double n = kIterations, exact = sum[c] / n;
        EXPECT_NEAR(double(means[c]) / exact, 1.0, 1e-6);
        const double ofMean = (squares[c] / n - exact * exact) / (n - 1.0);
        EXPECT_NEAR(double(variances[c]) / ofMean, 1.0, 1e-5);
        EXPECT_NEAR(film.meanColour().standardError[c] / std::sqrt(ofMean), 1.0, 1e-6);
    }
    EXPECT_FLOAT_EQ(mean.b, 0.1f);
    EXPECT_LT(std::sqrt(variance.b), 1e-7f);
}

TEST(FilmSum, countsIterationsBeyond32Bits) {
    const ThreadPool threads(1);
    FilmSum sum = FilmSum::ofIteration(std::vector<Rgb>{Rgb(1.0f)}, 1, threads);
    sum.spread = {Rgb(0.0f)};
    for (int doubled = 0; doubled < 35; ++doubled)
        join(sum, FilmSum(sum), SumRelation::Samples, nullptr);
    FilmSum other = sum;
    other.mean[0] = Rgb(3.0f);
    join(sum, other, SumRelation::Samples, nullptr);
    EXPECT_EQ(sum.iterations, 1ull << 36);
    EXPECT_EQ(sum.samples, 1ull << 36);
    EXPECT_EQ(sum.image(1, 1).at(0, 0), Rgb(2.0f));
    // Half of the samples are 1, half 3.
    EXPECT_NEAR(double(sum.variance(1, 1).at(0, 0).r) * std::pow(2.0, 36), 1.0, 1e-6);
}

// Connections of the first eye vertex are half of the first pixel and nothing of the other.
TEST(TechniqueFilm, isAMeanOverIterationsAndKnowsTheShareOfFirstConnections) {
    TechniqueFilm film(2, 1, 3);
    film.countIteration();
    film.add({1, 2, TechniqueGroup::of(1, 2, 1), 0, Rgb(3.0f), Rgb(6.0f)});
    film.add({0, 2, TechniqueGroup::of(0, 2, 1), 0, Rgb(1.0f), Rgb(1.0f)});  // a hit: no connection
    film.add({2, 1, TechniqueGroup::of(2, 1, 1), 0, Rgb(2.0f), Rgb(2.0f)});
    film.add({2, 1, TechniqueGroup::of(2, 1, 1), 1, Rgb(2.0f), Rgb(2.0f)});
    film.countIteration();
    EXPECT_EQ(film.weighted(1, 2).at(0, 0), Rgb(1.5f));
    EXPECT_EQ(film.unweighted(1, 2).at(0, 0), Rgb(3.0f));
    LayeredImage image(2, 1);
    for (const auto& [name, plane] : film.means()) image.channel(name) = plane;
    EXPECT_TRUE(image.hasRgb("unweighted.s00t02"));
    EXPECT_FALSE(image.hasRgb("weighted.s01t01")) << "black layers are left out";
    addShareOfFirstConnections(image, 3);
    EXPECT_FLOAT_EQ(image.channel("share.t02")[0], 0.5f);
    EXPECT_EQ(image.channel("share.t02")[1], 0.0f);
}

/// Layers as films join them. In each iteration of the `blocks`, technique s = 2, t = 3, behind a mirror, adds a value
/// in two halves, and s = 3, t = 2 adds one more to the same group.
Layers layersOf(const std::vector<std::vector<float>>& blocks, bool blocksAreSamples) {
    const BlockPlan plan{blocks[0].size(), blocksAreSamples};
    TechniqueFilm technique(1, 1, 4, plan.sampleIterations());
    Film film(1, 1, plan);
    film.addLayers(technique);
    const ThreadPool threads(1);
    for (const std::vector<float>& block : blocks) {
        for (const float value : block) {
            technique.add({2, 3, TechniqueGroup::of(2, 3, 1), 0, Rgb(0.5f * value), Rgb(value)});
            technique.add({2, 3, TechniqueGroup::of(2, 3, 1), 0, Rgb(0.5f * value), Rgb(value)});
            technique.add({3, 2, TechniqueGroup::of(3, 2, 1), 0, Rgb(1.0f), Rgb(1.0f)});
            technique.countIteration();
            film.add(std::vector<Rgb>{Rgb(value)}, threads);
        }
    }
    return film.sum().layers;
}

// Of 1, 5, 3, 7: mean 4, variance 20 / 3 of one and 5 / 3 of the mean; of the blocks' means 3, 5:
// variance 2 of one and 1 of the mean.
TEST(TechniqueFilm, knowsTheVarianceOfEachTechniqueAndGroup) {
    const std::vector<std::vector<float>> blocks{{1, 5}, {3, 7}};
    for (const bool blocksAreSamples : {false, true}) {
        const Layers layers = layersOf(blocks, blocksAreSamples);
        const std::uint64_t samples = blocksAreSamples ? 2 : 4;
        const float expected = blocksAreSamples ? 1.0f : 5.0f / 3.0f;
        EXPECT_FLOAT_EQ(techniqueVariance(layers, "s02t03", samples)[0], expected);
        EXPECT_FLOAT_EQ(techniqueVariance(layers, "s03t02", samples)[0], 0.0f);
        EXPECT_FLOAT_EQ(layers.at("weighted.connections1")[0], 5.0f);
        EXPECT_FLOAT_EQ(techniqueVariance(layers, "connections1", samples)[0], expected);
        EXPECT_TRUE(techniqueVariance(layers, "direct1", samples).empty());
        EXPECT_EQ(techniqueVariance(layers, "connections1", 1)[0], 0.0f) << "nobody knows";
        LayeredImage image(1, 1);
        for (const auto& [name, plane] : layers) image.channel(name) = plane;
        setTechniqueVariances(image, layers, samples);
        EXPECT_FLOAT_EQ(image.channel("variance.s02t03")[0], expected);
        EXPECT_FALSE(image.find("square.s02t03"));
        const std::vector<std::string> names = TechniqueFilm::channelNames(4);
        for (const auto& [name, plane] : image.channels()) {
            EXPECT_NE(std::ranges::find(names, name), names.end()) << name;
        }
    }
}

// Two groups of lights over blocks of five iterations, samples of two: the fifth is one alone.
TEST(LightProducts, areTheCovariancesOfSamples) {
    const ThreadPool threads(1);
    const std::vector<float> first{1, 5, 3, 7, 2, 4, 4, 9, 1, 0},
        second{5, 4, 0, 1, 4, 2, 2, 0, 1, 6};
    constexpr std::uint64_t kBlock = 5;
    LightProducts products(2, 1, 2);
    /// Gives the products to a film as layers.
    class Kept final : public BlockLayers {
      public:
        explicit Kept(LightProducts& of) : of_(of) {}
        Layers means() const override {
            LayeredImage image(1, 1);
            of_.setMeans(image);
            return image.channels();
        }
        void clear() override { of_.clear(); }

      private:
        LightProducts& of_;
    } kept(products);
    Film film(1, 1, {kBlock, false, 2});
    film.addLayers(kept);
    for (std::size_t i = 0; i < first.size(); ++i) {
        const std::vector<std::vector<Rgb>> now{{Rgb(first[i])}, {Rgb(second[i])}};
        products.add(now, threads);
        film.add(std::vector<Rgb>{Rgb(first[i] + second[i])}, threads);
    }
    const FilmSum sum = film.sum();
    ASSERT_EQ(sum.samples, 6u);
    LayeredImage image(1, 1);
    for (const auto& [name, plane] : sum.layers) image.channel(name) = plane;
    image.setRgb("a", Image(1, 1, Rgb(3.6f)));
    image.setRgb("b", Image(1, 1, Rgb(2.5f)));
    const std::array<std::string, 2> means{"a", "b"};
    setLightCovariances(image, means, sum.samples);

    const auto covariance = [&](const auto& f, const auto& g) {
        double fMean = 0, gMean = 0, all = 0;
        for (std::size_t i = 0; i < f.size(); ++i) {
            fMean += f[i] / 10.0;
            gMean += g[i] / 10.0;
        }
        for (std::size_t i = 0; i < f.size();) {
            const std::size_t n = i % kBlock == 4 ? 1 : 2;
            const double fSum = n == 1 ? f[i] : f[i] + f[i + 1];
            const double gSum = n == 1 ? g[i] : g[i] + g[i + 1];
            const double count = double(n);
            all += count * (fSum / count - fMean) * (gSum / count - gMean);
            i += n;
        }
        return float(all / (10.0 * 5.0));
    };
    const auto at = [&](const char* layer) {
        return image.rgb(std::string("covariance.") + layer).at(0, 0).g;
    };
    EXPECT_NEAR(at("g00g00"), covariance(first, first), 1e-5f);
    EXPECT_NEAR(at("g00g01"), covariance(first, second), 1e-5f);
    EXPECT_NEAR(at("g01g01"), covariance(second, second), 1e-5f);
    EXPECT_NEAR(at("g00g00") + 2 * at("g00g01") + at("g01g01"), film.variance().at(0, 0).g, 1e-5f);
    EXPECT_LT(at("g00g01"), 0.0f) << "or the sign would not be tested";
    EXPECT_FALSE(image.hasRgb("product.g00g01"));
    EXPECT_EQ(
        lightCovarianceLayers(2),
        (std::vector<std::string>{"covariance.g00g00", "covariance.g00g01", "covariance.g01g01"}));
}

TEST(TechniqueGroup, numbersAndNamesAreItsOwn) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < TechniqueGroup::kCount; ++i) {
        EXPECT_EQ(TechniqueGroup::at(i).index(), i);
        names.insert(TechniqueGroup::at(i).name());
    }
    EXPECT_EQ(names.size(), TechniqueGroup::kCount);
    EXPECT_EQ(TechniqueGroup::of(5, 1, 1).name(), "splats");
    EXPECT_EQ(TechniqueGroup::of(0, 4, 2).name(), "hits2");
    EXPECT_EQ(TechniqueGroup::of(1, 2, 1).name(), "direct1");
    EXPECT_EQ(TechniqueGroup::of(2, 9, 8).name(), "connections3");
}

TEST(TechniqueClock, givesItsTimeToGroupsWhereItIsOn) {
    TechniqueClock off;
    off.start();
    off.lap([]() -> TechniqueGroup { throw std::logic_error("asked for nothing"); });
    TechniqueClock clock;
    clock.switchOn();
    clock.start();
    while (clock.seconds()[0] == 0.0) clock.lap([] { return TechniqueGroup{}; });
    const auto direct = [](std::size_t i) { return TechniqueGroup::of(1, 2, int(i) + 1); };
    clock.start();
    while (clock.seconds()[TechniqueGroup::of(1, 2, 1).index()] == 0.0) {
        clock.lapAmong(2, direct);
    }
    EXPECT_DOUBLE_EQ(clock.seconds()[TechniqueGroup::of(1, 2, 1).index()],
                     clock.seconds()[TechniqueGroup::of(1, 2, 2).index()]);
}

}  // namespace
}  // namespace lacuna::test
