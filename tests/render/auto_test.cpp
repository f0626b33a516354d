// --method auto, and what people try first: a scene and nothing else.
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "libcore/base/rng.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "render/choose/choice.h"
#include "render/choose/judge.h"
#include "render/choose/processor_share.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

class RenderAuto : public RenderTool {
  protected:
    /// A quick render by `auto`, to @`name`.exr and @`name`.json.
    std::string automatic(const std::string& name, const std::string& more = "") const {
        return "@room.gltf -o @" + name + ".exr --json @" + name + ".json --cache @" + name +
               "-cache --quiet --max-depth 6 --width 24 --height 16 " + more;
    }
};

TEST_F(RenderAuto, SaysWhatItChoseAndHowToAskForItByName) {
    ASSERT_EQ(run(automatic("auto", "--iterations 3")).exitCode, 0);
    const nlohmann::json chosen = json("auto.json")["chosen"];
    EXPECT_EQ(chosen["method"], json("auto.json")["method"]);
    EXPECT_FALSE(chosen["why"].get<std::string>().empty());
    EXPECT_EQ(chosen["speeds"]["bpt"], 1.0);
    EXPECT_EQ(chosen["speeds"].size(), 3u);
    const auto attributes = readExrLayers(path("auto.exr")).attributes;
    EXPECT_EQ(nlohmann::json::parse(std::get<std::string>(attributes.at("chosen"))), chosen);

    const Outcome named =
        run(automatic("named", "--iterations 3 ") + chosen["by_name"].get<std::string>());
    ASSERT_EQ(named.exitCode, 0) << named.err;
    EXPECT_FALSE(json("named.json").contains("chosen"));
    const Image a = readExr(path("auto.exr")), b = readExr(path("named.exr"));
    EXPECT_EQ(a.pixels, b.pixels);
    // stderr tells the choice, unless --quiet.
    const Outcome loud = run("@room.gltf -o @x.exr --cache @cache --scale 10% --iterations 1");
    EXPECT_NE(loud.err.find("the same by name: --method "), std::string::npos) << loud.err;
}

// In this scene a lamp is seen through glass, and lights what is seen through glass. Its bright sparks are rare, so
// trials need to be long, and their length follows the iterations.
TEST_F(RenderAuto, MergesOnlyIfItMay) {
    const std::string scene = std::string(LACUNA_SCENES) + "/kitchen-glass.glb";
    const auto chosen = [&](const std::string& name, const std::string& more) {
        const Outcome o = run(scene + " -o @" + name + ".exr --json @" + name +
                              ".json --cache @cache --quiet --width 96 --height 54 "
                              "--iterations 600 --time 0.5 " +
                              more);
        EXPECT_EQ(o.exitCode, 0) << o.err;
        return json(name + ".json");
    };
    const nlohmann::json plain = chosen("plain", ""), biased = chosen("biased", "--allow-bias");
    EXPECT_EQ(plain["consistent"], false);
    EXPECT_EQ(plain["chosen"]["speeds"].size(), 3u);
    EXPECT_EQ(biased["consistent"], true) << biased["chosen"];
    EXPECT_EQ(biased["chosen"]["speeds"].size(), 5u);
    const std::string why = biased["chosen"]["why"];
    EXPECT_NE(why.find("through glass or mirrors"), std::string::npos) << why;
}

TEST_F(RenderAuto, IsTheSameOnAnyNumberOfThreads) {
    ASSERT_EQ(run(automatic("one", "--iterations 2 --threads 1")).exitCode, 0);
    ASSERT_EQ(run(automatic("three", "--iterations 2 --threads 3")).exitCode, 0);
    EXPECT_EQ(json("one.json")["chosen"], json("three.json")["chosen"]);
    EXPECT_EQ(readExr(path("one.exr")).pixels, readExr(path("three.exr")).pixels);
}

TEST_F(RenderAuto, NumbersAreEvenUnlessSomeoneSaysOtherwise) {
    for (const char* iterations : {"2", "15"}) {
        ASSERT_EQ(run(automatic("n", std::string("--iterations ") + iterations)).exitCode, 0);
        EXPECT_EQ(json("n.json")["sampler"], "sobol");
        EXPECT_GT(json("n.json")["mean_rgb_stderr"][0], 0.0) << iterations;
    }
    ASSERT_EQ(run(automatic("n", "--iterations 2 --sampler independent")).exitCode, 0);
    EXPECT_EQ(json("n.json")["sampler"], "independent");
}

TEST_F(RenderAuto, ACheckpointKeepsTheChoice) {
    ASSERT_EQ(run(automatic("a", "--checkpoint @ck --time 0.3s")).exitCode, 0);
    const std::string method = json("a.json")["method"];
    ASSERT_EQ(run(automatic("b", "--checkpoint @ck --time 0.6s")).exitCode, 0);
    EXPECT_EQ(json("b.json")["method"], method);
    EXPECT_EQ(json("b.json")["parameters"], json("a.json")["parameters"]);
    EXPECT_GE(json("b.json")["iterations"], json("a.json")["iterations"]);
    EXPECT_EQ(json("b.json")["chosen"]["why"], "as the checkpoint has it");
}

TEST_F(RenderAuto, ACropOfAHugePictureTakesAsLongAsTheCrop) {
    // One light subpath per pixel of the whole picture would take 60 million rays.
    const Outcome o =
        run("@room.gltf -o @crop.exr --json @crop.json --cache @crop-cache --quiet "
            "--width 4000 --height 2000 --crop 2000,2010,1000,1010 --iterations 2 --allow-bias");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    EXPECT_LT(json("crop.json")["rays"], 4e5);
    const auto named = json("crop.json")["chosen"]["by_name"].get<std::string>();
    EXPECT_EQ(named.find("light_paths=10000") == std::string::npos,
              json("crop.json")["method"] == "pt")
        << named;
    EXPECT_EQ(json("crop.json")["chosen"]["speeds"].size(), 4u) << "vcm sees the whole film";
}

TEST_F(RenderAuto, PartsMergeToThePicture) {
    const std::string blocks = "--iterations 6 --block-iterations 2 ";
    ASSERT_EQ(run(automatic("whole", blocks)).exitCode, 0);
    ASSERT_EQ(run(automatic("p", blocks + "--blocks 0,2")).exitCode, 0);
    ASSERT_EQ(run(automatic("q", blocks + "--blocks 2,3")).exitCode, 0);
    ASSERT_EQ(run("@p.exr @q.exr -o @merged.exr", LACUNA_MERGE).exitCode, 0);
    EXPECT_EQ(readExr(path("merged.exr")).pixels, readExr(path("whole.exr")).pixels);
}

TEST_F(RenderAuto, DoesWithoutAFolderForCaches) {
    write("file", "no folder");
    const Outcome o =
        run("@room.gltf -o @out.exr --json @o.json --width 24 --height 16 "
            "--iterations 1 --cache @file/cache");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    EXPECT_NE(o.err.find("does without sharebpt"), std::string::npos) << o.err;
    EXPECT_EQ(json("o.json")["chosen"]["speeds"].size(), 2u);
}

TEST_F(RenderAuto, ASceneWithoutLightIsBlackAtOnce) {
    TinyScene dark;
    dark.lamp = false;
    write("dark.gltf", dark.text());
    const Outcome o = run("@dark.gltf -o @out.exr --json @o.json --width 24 --height 16");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    EXPECT_EQ(json("o.json")["method"], "pt");
}

TEST_F(RenderAuto, EffectsNeedNoChoice) {
    EXPECT_EQ(run("@room.gltf --effects").out, run("@room.gltf --effects --method auto").out);
    // The picture's own effects are those of the chosen row.
    ASSERT_EQ(run(automatic("on", "--iterations 1")).exitCode, 0);
    ASSERT_EQ(run(automatic("named", "--iterations 1 ") +
                  json("on.json")["chosen"]["by_name"].get<std::string>())
                  .exitCode,
              0);
    EXPECT_EQ(json("on.json")["effects"], json("named.json")["effects"]);
    // A technique that is off stays off, whichever row is chosen.
    ASSERT_EQ(run(automatic("off", "--iterations 1 --effect splats=off")).exitCode, 0);
    EXPECT_EQ(json("off.json")["rays_by_kind"]["splat"], 0);
}

TEST_F(RenderAuto, ASceneAloneIsEnough) {
    const Outcome o = run("@room.gltf --scale 2% --samples 1");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    EXPECT_TRUE(exists("room.png"));
    EXPECT_NE(o.out.find("room.png"), std::string::npos) << o.out;
    const std::string first = read("room.png");
    // The tool replaces its own picture, but never a file of somebody else.
    EXPECT_EQ(run("@room.gltf --scale 2% --samples 1").exitCode, 0);
    EXPECT_EQ(read("room.png"), first);
    write("room.png", "a texture");
    expectFailure("@room.gltf --scale 2% --samples 1", 2, "room.png");
    EXPECT_EQ(read("room.png"), "a texture");
}

TEST_F(RenderAuto, SizesAsPeopleWriteThem) {
    const auto size = [&](const std::string& options) {
        const Outcome o =
            run("@room.gltf -o @s.exr --json @s.json --method pt --iterations 1 "
                "--max-depth 1 " +
                options);
        EXPECT_EQ(o.exitCode, 0) << o.err;
        const nlohmann::json j = json("s.json");
        return std::pair<int, int>(j["width"], j["height"]);
    };
    EXPECT_EQ(size("--size 40x30"), std::pair(40, 30));
    EXPECT_EQ(size("--width 40 --height 30 --scale 50%"), std::pair(20, 15));
    EXPECT_EQ(size("--width 40 --height 30 --size 150%"), std::pair(60, 45));
    EXPECT_EQ(size("--scale 10%").first, 128);
}

/// A picture whose halves have independent relative noise in proportion to `sigma`; `seen` is its share of the light.
HalfPictures noisy(double sigma, double seen, std::uint64_t seed) {
    HalfPictures p;
    Rng rng(seed, 0, StreamKind::User, 0);
    for (auto* half : {&p.first, &p.second}) {
        for (int i = 0; i < 4096; ++i) {
            // The mean of two such halves is off by a sixth of the range on average.
            const double range = 4.0 * sigma;  // |mean of two| has a third of it
            const double value = 1.0 + range * (double(rng.uniform()) - 0.5);
            half->push_back(Rgb(float(seen * value)));
        }
    }
    return p;
}

TEST(Judge, TellsTheNoiseOfPicturesApart) {
    const HalfPictures all[] = {noisy(0.1, 1.0, 1), noisy(0.2, 1.0, 2), noisy(0.05, 1.0, 3)};
    const std::vector<double> e = errorsOf(all, 64);
    EXPECT_NEAR(e[1] / e[0], 2.0, 0.2);
    EXPECT_NEAR(e[0] / e[2], 2.0, 0.2);
}

// As in scenes with difficult light: each picture is right except for a few pixels, which differ between pictures.
TEST(Judge, RareErrorsOfTwoPicturesAddUp) {
    const auto sparkling = [](double rate, std::uint64_t seed) {
        HalfPictures p;
        Rng rng(seed, 0, StreamKind::User, 0);
        for (auto* half : {&p.first, &p.second}) {
            for (int i = 0; i < 4096; ++i) {
                half->push_back(Rgb(rng.uniform() < float(rate) ? 2.0f : 1.0f));
            }
        }
        return p;
    };
    // The mean of both halves is off by 1/2 in twice as many pixels, which is `rate` on average. A few of them
    // coincide, and the mean is a little above 1.
    const HalfPictures all[] = {sparkling(0.02, 1), sparkling(0.04, 2), sparkling(0.08, 3)};
    const std::vector<double> e = errorsOf(all, 64);
    EXPECT_NEAR(e[0], 0.02, 0.005);
    EXPECT_NEAR(e[1], 0.04, 0.006);
    EXPECT_NEAR(e[2], 0.08, 0.016);
}

TEST(Judge, SeesLightThatAPictureLacks) {
    // The third one has hardly any noise, because it never meets half of the light.
    const HalfPictures all[] = {noisy(0.1, 1.0, 1), noisy(0.1, 1.0, 2), noisy(0.01, 0.5, 3)};
    const std::vector<double> e = errorsOf(all, 64);
    EXPECT_GT(e[2], 3.0 * e[0]);
    EXPECT_GT(e[2], 3.0 * e[1]);
}

TEST(Judge, ManagesFewPicturesAndBlackOnes) {
    const HalfPictures one[] = {noisy(0.1, 1.0, 1)};
    EXPECT_GT(errorsOf(one, 64)[0], 0.0);
    const HalfPictures two[] = {noisy(0.1, 1.0, 1), noisy(0.3, 1.0, 2)};
    const std::vector<double> e = errorsOf(two, 64);
    EXPECT_LT(e[0], e[1] * 1.01);
    const HalfPictures black[] = {noisy(0.1, 0.0, 1), noisy(0.1, 0.0, 2), noisy(0.1, 0.0, 3)};
    for (const double error : errorsOf(black, 64)) EXPECT_EQ(error, 0.0);
}

TEST(Judge, KeepsTheUsualRowUnlessAnotherIsClearlyBetter) {
    const auto taken = [](std::initializer_list<Verdict> verdicts) {
        return rowToTake(std::vector(verdicts), 1);
    };
    EXPECT_EQ(taken({{0.1, 0.9}, {0.1, 1.0}, {0.1, 2.0}}), 1u);
    EXPECT_EQ(taken({{0.1, 0.8}, {0.1, 1.0}, {0.1, 0.7}}), 2u);
    // Black pictures agree with each other. The less light the trials met, the clearer the difference must be.
    EXPECT_EQ(taken({{0.5, 0.5}, {0.5, 1.0}, {0.5, 0.6}}), 1u);
    EXPECT_EQ(taken({{0.5, 0.4}, {0.5, 1.0}, {0.5, 0.6}}), 0u);
    EXPECT_EQ(taken({{0.9, 0.01}, {1.1, 1.0}, {0.1, 0.02}}), 1u);
    EXPECT_EQ(taken({{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}}), 1u);
}

TEST(ProcessorShare, IsWhatOthersLeave) {
    if (!std::ifstream("/proc/self/schedstat")) GTEST_SKIP() << "the system does not tell";
    const ProcessorShare processors;
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < 4 * std::thread::hardware_concurrency(); ++i) {
        threads.emplace_back([&] {
            while (std::chrono::steady_clock::now() < end) {
            }
        });
    }
    // Reads before the threads end, because the time that they waited goes with them.
    std::this_thread::sleep_until(end - std::chrono::milliseconds(50));
    EXPECT_GT(processors.value(), 0.0);
    EXPECT_LT(processors.value(), 0.6);  // 1/4 if the threads share all processors
}

TEST(Choices, TravelAsText) {
    const RowChoice choice{
        "spcbpt", {"train.paths=4000"}, Sampling::Sobol, "because", {{"bpt", 1.0}}};
    const RowChoice read = RowChoice::ofText(choice.text());
    EXPECT_EQ(read.json(), choice.json());
    EXPECT_EQ(choice.byName(), "--method spcbpt --prepare --set train.paths=4000 --sampler sobol");
}

}  // namespace
}  // namespace lacuna::test
