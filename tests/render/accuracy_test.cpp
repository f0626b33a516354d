// --until, --estimate, and the error in the progress line.
#include <cmath>
#include <nlohmann/json.hpp>

#include "libcore/image/exr.h"
#include "render/accuracy.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

class RenderUntil : public RenderTool {
  protected:
    /// Renders 64 x 48 pixels of the room to out.exr and o.json. 43 iterations have enough paths for a promise.
    std::string room(const std::string& method, const std::string& more) const {
        return "@room.gltf -o @out.exr --json @o.json --quiet --width 64 --height 48 --max-depth 4 "
               "--method " +
               method + " " + cheap(method) + " " + more;
    }
    LayeredImage picture() const { return readExrLayers(path("out.exr")); }
};

/// The part of the JSON that depends neither on the clock nor on how the picture was asked for.
nlohmann::json figures(const nlohmann::json& j) {
    nlohmann::json kept;
    for (const char* key : {"iterations", "stopped", "estimated_error", "mean_rgb", "rays"}) {
        kept[key] = j.at(key);
    }
    return kept;
}

TEST_F(RenderUntil, stopsAtASetCountWithThePictureOfThatManyIterations) {
    for (const char* method : {"pt", "lvcbpt"}) {
        SCOPED_TRACE(method);
        ASSERT_EQ(run(room(method, "--until mape=0.3")).exitCode, 0);
        const nlohmann::json j = json("o.json");
        EXPECT_EQ(j["stopped"], "error");
        EXPECT_LT(j["estimated_error"]["mape"].get<double>(), 0.3);
        EXPECT_FALSE(j["estimate_doubts"].contains("mape"));
        const std::uint64_t n = j["iterations"];
        EXPECT_TRUE(isMeasured(n)) << n;
        const auto stopped = picture();
        ASSERT_EQ(run(room(method, "--threads 1 --iterations " + std::to_string(n))).exitCode, 0);
        EXPECT_TRUE(picture().channels() == stopped.channels());
        EXPECT_EQ(json("o.json")["estimated_error"], j["estimated_error"]);
    }
}

// Compares with the same picture at many times the iterations.
TEST_F(RenderUntil, theErrorIsWhatWasAskedFor) {
    std::filesystem::copy_file(std::string(LACUNA_SCENES) + "/cornell-box.glb", path("room.gltf"),
                               std::filesystem::copy_options::overwrite_existing);
    ASSERT_EQ(run(room("bpt", "--iterations 1000 --seed 5")).exitCode, 0);
    std::filesystem::rename(path("out.exr"), path("reference.exr"));
    for (const auto& [measure, bound] : {std::pair{"mape", 0.08}, std::pair{"relmse", 0.02}}) {
        const std::string until = std::string("--until ") + measure + "=" + std::to_string(bound);
        const std::string more = until + " --reference @reference.exr --iterations 200";
        ASSERT_EQ(run(room("bpt", more)).exitCode, 0);
        const nlohmann::json j = json("o.json");
        EXPECT_EQ(j["stopped"], "error") << measure << j["estimate_doubts"];
        EXPECT_LT(j["error"][measure].get<double>(), 1.1 * bound) << measure;
        EXPECT_GT(j["error"][measure].get<double>(), 0.3 * bound) << measure;
    }
}

TEST_F(RenderUntil, goesOnFromACheckpointToTheSameEnd) {
    for (const char* method : {"bpt", "tsrbpt"}) {
        SCOPED_TRACE(method);
        const std::string common = room(method, "--block-iterations 8 ");
        ASSERT_EQ(run(common + "--until mape=0.3").exitCode, 0);
        const nlohmann::json whole = json("o.json");
        const auto channels = picture().channels();
        ASSERT_GT(whole["iterations"], 13);
        for (const char* limit : {"--iterations 5", "--iterations 13", ""}) {
            const Outcome o = run(common + "--checkpoint @ck --until mape=0.3 " + limit);
            ASSERT_EQ(o.exitCode, 0) << o.err;
        }
        EXPECT_EQ(figures(json("o.json")), figures(whole));
        EXPECT_TRUE(picture().channels() == channels);
        // A finished render stays as it is.
        ASSERT_EQ(run(common + "--checkpoint @ck --until mape=0.3").exitCode, 0);
        EXPECT_EQ(figures(json("o.json")), figures(whole));
        std::filesystem::remove(path("ck"));
    }
}

TEST_F(RenderUntil, theSoonerLimitEndsIt) {
    ASSERT_EQ(run(room("pt", "--until mape=0.0001 --iterations 9")).exitCode, 0);
    EXPECT_EQ(json("o.json")["stopped"], "iterations");
    ASSERT_EQ(run(room("pt", "--until mape=0.0001 --time 0.3s")).exitCode, 0);
    EXPECT_EQ(json("o.json")["stopped"], "time");
    ASSERT_EQ(run(room("pt", "--until mape=9 --time 1h")).exitCode, 0);
    EXPECT_EQ(json("o.json")["stopped"], "error");
}

TEST_F(RenderUntil, whatCannotBePromisedIsSaidAndNotStopped) {
    std::string text = room("bpt", "--until mape=0.9 --iterations 24 --crop 0,2,0,2");
    const Outcome o = run(text.erase(text.find("--quiet "), 8));
    ASSERT_EQ(o.exitCode, 0);
    EXPECT_EQ(json("o.json")["stopped"], "iterations");
    EXPECT_TRUE(json("o.json")["estimate_doubts"].contains("mape"));
    EXPECT_NE(o.err.find("--until: cannot be promised yet: "), std::string::npos) << o.err;
}

// A scene without light is known to be black.
TEST_F(RenderUntil, aSceneWithoutLightIsDone) {
    TinyScene dark;
    dark.lamp = false;
    write("room.gltf", dark.text());
    ASSERT_EQ(run(room("bpt", "--until mape=0.1")).exitCode, 0);
    EXPECT_EQ(json("o.json")["stopped"], "error");
    EXPECT_EQ(json("o.json")["estimated_error"]["mape"], 0.0);
}

TEST_F(RenderUntil, errorsAreUsage) {
    for (const char* text : {"mape=0", "mape=-1", "mape=x", "mape=", "mape", "foo=1", "mape=nan",
                             "mape=inf", "=0.1", "mape=0.1x", "mae=0.1"}) {
        expectFailure("@none.glb -o @out.exr --method pt --until '" + std::string(text) + "'", 2,
                      "--until");
    }
    const std::string start = "@none.glb -o @out.exr --method pt ";
    expectFailure(start + "--until mape=0.1 --blocks 0,1", 2, "--blocks");
    expectFailure(start + "--until mape=0.1 --estimate", 2, "--estimate");
    expectFailure(start + "--estimate --checkpoint @ck", 2, "--checkpoint");
    expectFailure(start + "--estimate --blocks 0,1", 2, "--blocks");
    expectFailure(start + "--estimate --verify", 2, "--verify");
}

class RenderEstimate : public RenderUntil {};

TEST_F(RenderEstimate, printsWhatAccuracyCosts) {
    // Under a sanitizer, a second has too few iterations for a promise.
    const std::string time = LACUNA_SANITIZED ? "20" : "1";
    const Outcome o =
        run("@room.gltf --width 64 --height 48 --max-depth 4 --method bpt --estimate --time " +
            time + " --json @e.json --quiet");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const nlohmann::json j = json("e.json");
    EXPECT_TRUE(j["promised"].get<bool>()) << o.out;
    ASSERT_EQ(j["costs"].size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) {
        const double mape = std::array{0.2, 0.1, 0.05, 0.02, 0.01}[i];
        EXPECT_EQ(j["costs"][i]["mape"], mape);
        const double root = j["mape"].get<double>() / mape;
        EXPECT_NEAR(j["costs"][i]["seconds"].get<double>(),
                    j["seconds"].get<double>() * root * root, 1e-6 * root * root);
    }
    for (const char* part : {"64 x 48 pixels, bpt", "setup", "  20 % ", "   1 % "}) {
        EXPECT_NE(o.out.find(part), std::string::npos) << o.out;
    }
    EXPECT_FALSE(exists("out.exr"));
}

TEST_F(RenderEstimate, saysWhereNothingCanBePromised) {
    const Outcome o =
        run("@room.gltf --width 2 --height 2 --method bpt --estimate --time 0.05 --json @e.json "
            "--quiet");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    EXPECT_NE(o.out.find("cannot be promised"), std::string::npos) << o.out;
    EXPECT_FALSE(json("e.json")["promised"].get<bool>());
    EXPECT_TRUE(json("e.json")["costs"].empty());
}

TEST(RenderAccuracy, isSaidInTheProgressLine) {
    const auto said = [](double error, double bound, const char* measure = "mape") {
        return accuracyText({measure, error, 60.0, false}, bound);
    };
    EXPECT_EQ(said(0.041, 0.0), "mape 4.1 %, 2 % in 3m12s");
    EXPECT_EQ(said(0.041, 0.03), "mape 4.1 %, 3 % in 52s");
    EXPECT_EQ(said(0.041, 0.001), "mape 4.1 %, 2 % in 3m12s");
    EXPECT_EQ(said(0.00041, 0.0), "mape 0.041 %");
    EXPECT_EQ(said(0.4, 0.0, "relmse"), "relmse 0.4");
    EXPECT_EQ(said(0.4, 0.1, "relmse"), "relmse 0.4, 0.1 in 3m00s");
    EXPECT_EQ(said(0.4, 0.1, "rmse"), "rmse 0.4, 0.1 in 15m00s");
    EXPECT_EQ(accuracyText({"mape", 0.041, 60.0, true}, 0.0), "mape 4.1 % at least");
    EXPECT_EQ(accuracyText({"mape", std::nan(""), 0.0, true}, 0.0), "mape not known yet");
    const ErrorNow later = ErrorNow{"mape", 0.04, 60.0, false}.after(180.0);
    EXPECT_NEAR(later.error, 0.02, 1e-12);
    EXPECT_EQ(later.seconds, 240.0);
}

}  // namespace
}  // namespace lacuna::test
