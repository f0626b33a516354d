// Time limits and interrupts.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "libcore/image/exr.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

using std::chrono::milliseconds;

class RenderTime : public RenderTool {};
class RenderTimeSlow : public RenderTool {};
class RenderInterrupt : public RenderTool {};

TEST_F(RenderTime, TheSoonerLimitEndsIt) {
    ASSERT_EQ(run(quick("pt", "--quiet --time 1h --iterations 3 --json @o.json")).exitCode, 0);
    EXPECT_EQ(json("o.json")["stopped"], "iterations");
    EXPECT_EQ(json("o.json")["iterations"], 3);

    ASSERT_EQ(run("@room.gltf -o @out.exr --method pt --width 24 --height 16 --quiet --time 0.5s "
                  "--json @o.json")
                  .exitCode,
              0);
    const nlohmann::json j = json("o.json");
    EXPECT_EQ(j["stopped"], "time");
    EXPECT_GT(j["iterations"].get<int>(), 3);
    // Iterations take milliseconds, so it ends close to the limit, on either side.
    EXPECT_GT(j["seconds"].get<double>(), 0.3);
    EXPECT_LT(j["seconds"].get<double>(), 1.5);
}

TEST_F(RenderTime, SetupCountsOnlyIfAskedFor) {
    // The setup alone takes longer than a microsecond. The first iteration is always rendered; with setup counted, no
    // other is.
    const std::string start =
        "@room.gltf -o @out.exr --method pt --width 8 --height 8 --quiet --json @o.json ";
    ASSERT_EQ(run(start + "--time 0.000001s --count-setup").exitCode, 0);
    EXPECT_EQ(json("o.json")["iterations"], 1);
    EXPECT_EQ(json("o.json")["stopped"], "time");
    ASSERT_EQ(run(start + "--time 0.000001s").exitCode, 0);
    EXPECT_EQ(json("o.json")["iterations"], 1);
}

TEST_F(RenderTimeSlow, AnIterationThatWouldEndFarPastTheLimitIsNotBegun) {
    const std::string start =
        "@room.gltf -o @out.exr --method bpt --width 400 --height 300 --quiet "
        "--json @o.json ";
    ASSERT_EQ(run(start + "--iterations 1").exitCode, 0);
    const double one = json("o.json")["seconds"];
    // Time for one and a quarter iterations: the second would end 60 % past the limit.
    ASSERT_EQ(run(start + "--time " + std::to_string(1.25 * one) + "s").exitCode, 0);
    EXPECT_LT(json("o.json")["seconds"].get<double>(), 2.0 * 1.25 * one);
    EXPECT_EQ(json("o.json")["stopped"], "time");
}

TEST_F(RenderInterrupt, SavesWhatThereIs) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const Outcome o = runAndSignal(
            "@room.gltf -o @out.exr --method pt --width 24 --height 16 --time 1h --json @o.json "
            "--log @o.csv",
            {signal}, milliseconds(1500));
        EXPECT_EQ(o.exitCode, 130) << o.err;
        EXPECT_NE(o.out.find("interrupted"), std::string::npos) << o.out;
        const LayeredImage image = readExrLayers(path("out.exr"));
        EXPECT_EQ(std::get<std::string>(image.attributes.at("stopped")), "interrupt");
        const nlohmann::json j = json("o.json");
        EXPECT_EQ(j["stopped"], "interrupt");
        EXPECT_EQ(j["iterations"], std::get<int>(image.attributes.at("iterations")));
        std::string row(1, '\n');
        row.append(j["iterations"].dump()).append(",");
        EXPECT_NE(read("o.csv").find(row), std::string::npos);
        double sum = 0.0;
        for (const float v : *image.find("G")) sum += v;
        EXPECT_GT(sum, 0.0);
        EXPECT_TRUE(temporaries().empty());
        std::filesystem::remove(path("out.exr"));
    }
}

TEST_F(RenderInterrupt, TheFirstIterationIsFinished) {
    if (LACUNA_SANITIZED) GTEST_SKIP() << "a sanitizer is too slow for it";
    // One iteration of about a second, interrupted in its middle.
    const Outcome o = runAndSignal(
        "@room.gltf -o @out.exr --method bpt --width 600 --height 400 --time 1h --json @o.json",
        {SIGINT}, milliseconds(400));
    EXPECT_EQ(o.exitCode, 130) << o.err;
    EXPECT_GE(json("o.json")["iterations"].get<int>(), 1);
    EXPECT_NE(o.err.find("interrupted"), std::string::npos) << o.err;
    // The picture is that of as many undisturbed iterations.
    const auto values = *readExrLayers(path("out.exr")).find("R");
    ASSERT_EQ(run("@room.gltf -o @out.exr --method bpt --width 600 --height 400 --quiet "
                  "--iterations " +
                  json("o.json")["iterations"].dump())
                  .exitCode,
              0);
    EXPECT_EQ(values, *readExrLayers(path("out.exr")).find("R"));
}

/// The iteration has three seconds to end. With light paths missing, nothing of it can be saved.
TEST_F(RenderInterrupt, AFirstIterationOfMinutesIsCut) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome o = runAndSignal(
        "@room.gltf -o @out.exr --method bpt --set light_paths=1000000000 --width 24 --height 16 "
        "--checkpoint @ck",
        {SIGINT}, milliseconds(500));
    EXPECT_EQ(o.exitCode, 130) << o.err;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(8));
    EXPECT_NE(o.err.find("nothing was written"), std::string::npos) << o.err;
    EXPECT_FALSE(exists("out.exr"));
    EXPECT_FALSE(exists("ck"));
    EXPECT_TRUE(temporaries().empty());
}

/// The layers beside the picture have the same three seconds. With so many pixels they take half a minute.
TEST_F(RenderInterrupt, LayersOfMinutesAreCut) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome o = runAndSignal(
        "@room.gltf -o @out.exr --method pt --width 6000 --height 4000 --threads 1 "
        "--time 1h",
        {SIGINT}, milliseconds(800));
    EXPECT_EQ(o.exitCode, 130) << o.err;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
    EXPECT_NE(o.err.find("nothing was written"), std::string::npos) << o.err;
    EXPECT_FALSE(exists("out.exr"));
}

/// The finished eye paths make a picture, but neither a part nor a checkpoint.
TEST_F(RenderInterrupt, WhatIsFinishedOfTheFirstIterationIsSaved) {
    const Outcome o = runAndSignal(
        "@room.gltf -o @out.exr --method lvcbpt --width 1600 --height 1600 --max-depth 254 "
        "--rr-depth 254 --set connections=64 --set candidates=1000 --set light_paths=1000 "
        "--json @o.json --checkpoint @ck",
        {SIGINT}, milliseconds(500));
    EXPECT_EQ(o.exitCode, 130) << o.err;
    EXPECT_NE(o.err.find("not finished"), std::string::npos) << o.err;
    EXPECT_EQ(json("o.json")["stopped"], "interrupt");
    EXPECT_NE(json("o.json")["warnings"].dump().find("not finished"), std::string::npos);
    const LayeredImage image = readExrLayers(path("out.exr"));
    const std::vector<float>& green = *image.find("G");
    EXPECT_TRUE(std::any_of(green.begin(), green.end(), [](float v) { return v > 0.0f; }));
    EXPECT_FALSE(exists("ck"));
}

/// lacuna-compare is done at once, so here it waits for a pipe that nobody reads.
TEST_F(RenderInterrupt, WithoutAnythingToSaveNothingIsWritten) {
    const std::string noise =
        "@room.gltf --method pt --width 400 --height 300 --iterations 1 --quiet";
    ASSERT_EQ(run(noise + " -o @a.exr").exitCode, 0);
    ASSERT_EQ(run(noise + " -o @b.exr --seed 2").exitCode, 0);
    ASSERT_EQ(mkfifo(path("map.png").c_str(), 0600), 0);
    const int reader = open(path("map.png").c_str(), O_RDONLY | O_NONBLOCK);
    ASSERT_GE(fcntl(reader, F_SETPIPE_SZ, 4096), 0);  // otherwise all of it may fit
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const Outcome o = runAndSignal("@a.exr @b.exr --error-map @map.png", {signal},
                                       milliseconds(600), LACUNA_COMPARE);
        EXPECT_EQ(o.exitCode, 130) << o.err;
        EXPECT_EQ(o.err, "interrupted: nothing is written\n");
    }
    close(reader);
}

/// The picture is finished then and is saved in any case. Here it goes into a pipe that nobody reads at first.
TEST_F(RenderInterrupt, WhileSavingChangesNothing) {
    if (LACUNA_SANITIZED) GTEST_SKIP() << "a sanitizer is too slow for it";
    ASSERT_EQ(mkfifo(path("out.png").c_str(), 0600), 0);
    const int reader = open(path("out.png").c_str(), O_RDONLY | O_NONBLOCK);
    ASSERT_GE(fcntl(reader, F_SETPIPE_SZ, 4096), 0);  // otherwise all of it may fit
    const pid_t child = start(
        "@room.gltf -o @out.png --method pt --width 400 --height 300 --iterations 1 --json "
        "@o.json");
    std::this_thread::sleep_for(milliseconds(1200));
    kill(child, SIGINT);
    std::this_thread::sleep_for(milliseconds(500));
    fcntl(reader, F_SETFL, 0);
    char bytes[4096];
    while (::read(reader, bytes, sizeof bytes) > 0) {
    }
    const Outcome o = end(child);
    close(reader);
    EXPECT_EQ(o.exitCode, 0) << o.err;
    EXPECT_NE(o.err.find("the picture is finished"), std::string::npos) << o.err;
    EXPECT_EQ(json("o.json")["stopped"], "iterations");
}

TEST_F(RenderInterrupt, TheSecondExitsAtOnce) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome o =
        runAndSignal("@room.gltf -o @out.exr --method bpt --width 3000 --height 3000 --time 1h",
                     {SIGINT, SIGINT}, milliseconds(1000));
    EXPECT_EQ(o.exitCode, 130) << o.err;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
    EXPECT_FALSE(exists("out.exr"));
    EXPECT_TRUE(temporaries().empty());
}

}  // namespace
}  // namespace lacuna::test
