// What lacuna-train says, writes and returns, and what lacuna-render makes of its file.
#include <signal.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <set>

#include "tests/render/render_tool.h"

namespace lacuna::test {
namespace {

class TrainTool : public RenderTool {
  protected:
    static constexpr const char* kSmall = " --paths 5000 --subspaces 50 --light-paths 5000";
    static constexpr const char* kSameSmall =
        "--set train.paths=5000 --set train.subspaces=50 --set train.light_paths=5000";

    Outcome train(const std::string& arguments) const { return run(arguments, LACUNA_TRAIN); }
    /// Of what training just wrote to --json @t.json.
    std::string trainedFile() const { return json("t.json").at("file"); }
    std::string render() const {
        std::string arguments = "@room.gltf -o @out.exr --method spcbpt --width 24 --height 16 ";
        arguments += "--iterations 2 --cache @cache --set candidates=100 ";
        return arguments += kSameSmall;
    }
};

TEST_F(TrainTool, CommandLinesThatAreWrongExitWith2) {
    EXPECT_EQ(train("--help").exitCode, 0);
    for (const char* wrong :
         {"--paths 0", "--paths 1e9", "--subspaces 0", "--subspaces 4001", "--light-paths 0",
          "--epochs -1", "--borrow maybe", "--nonsense", "--json @none.glb"}) {
        expectFailure(std::string("@none.glb ") + wrong, 2, std::string(wrong).substr(0, 6),
                      LACUNA_TRAIN);
    }
    expectFailure("", 2, "SCENE", LACUNA_TRAIN);
}

TEST_F(TrainTool, ScenesThatCannotBeUsedExitWith3) {
    expectFailure("@none.glb", 3, "none.glb", LACUNA_TRAIN);
    TinyScene blind;
    blind.camera = false;
    write("blind.gltf", blind.text());
    expectFailure(std::string("@blind.gltf --quiet --cache @cache") + kSmall, 3, "camera",
                  LACUNA_TRAIN);
    expectFailure("@room.gltf --quiet -o @none/t.subspaces", 1, "none", LACUNA_TRAIN);
}

TEST_F(TrainTool, ReportHasItsKeysAndTheRendererReadsTheFile) {
    const Outcome o = train(std::string("@room.gltf --cache @cache --json @t.json") + kSmall);
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const nlohmann::json j = json("t.json");
    for (const char* tree : {"light_tree", "eye_tree"}) {
        EXPECT_GT(j.at(tree).at("held_out_accuracy"), 0.0);
        EXPECT_LE(j.at(tree).at("held_out_accuracy"), 1.0);
        EXPECT_GT(j.at(tree).at("depth"), 1);
        EXPECT_GT(j.at(tree).at("leaves"), 1);
    }
    const nlohmann::json& gamma = j.at("gamma");
    EXPECT_LE(gamma.at("train_loss"), gamma.at("train_loss_full"));
    EXPECT_LE(gamma.at("held_out_loss"), gamma.at("held_out_loss_full"));
    EXPECT_EQ(gamma.at("train_loss_by_epoch").size(), gamma.at("held_out_loss_by_epoch").size());
    EXPECT_EQ(j.at("subspaces"), 50);
    EXPECT_LE(j.at("light_subspaces"), 50);
    // About: iterations are as many as the first one's number of paths says.
    EXPECT_NEAR(j.at("paths").get<double>(), 5000, 500);
    EXPECT_GT(j.at("held_out_paths"), 0);
    EXPECT_GE(j.at("empty_light_subspaces"), 0.0);
    for (const char* phase : {"paths", "centroids", "trees", "light paths", "gamma"}) {
        EXPECT_GT(j.at("phases").at(phase), 0.0) << phase;
        EXPECT_GT(j.at("phase_peak_bytes").at(phase), 1e6) << phase;
    }
    EXPECT_GT(j.at("seconds"), 0.0);
    EXPECT_GT(j.at("peak_bytes"), 1e6);
    EXPECT_NE(o.out.find("held-out accuracy"), std::string::npos) << o.out;
    EXPECT_NE(o.out.find("loss after epoch 0"), std::string::npos) << o.out;

    const Outcome rendered = run(render() + " --quiet --json @out.json --verify");
    ASSERT_EQ(rendered.exitCode, 0) << rendered.err;
    EXPECT_EQ(json("out.json").at("cache_hashes").at("subspaces"), j.at("content_hash"));
    EXPECT_LT(json("out.json").at("verify").at("max_difference"), 1e-6);
}

TEST_F(TrainTool, ResultDoesNotDependOnThreads) {
    std::vector<std::string> hashes;
    for (const char* threads : {"1", "2", "5"}) {
        const Outcome o = train(std::string("@room.gltf --quiet --cache @cache --json @t.json "
                                            "--threads ") +
                                threads + kSmall);
        ASSERT_EQ(o.exitCode, 0) << o.err;
        hashes.push_back(json("t.json").at("content_hash"));
    }
    EXPECT_EQ(hashes[1], hashes[0]);
    EXPECT_EQ(hashes[2], hashes[0]);
}

/// Another setting: another file with another content, which the renderer finds by the same
/// setting.
TEST_F(TrainTool, SettingsChangeFileAndContent) {
    const char* options[] = {"", " --epochs 3", " --borrow off"};
    const char* settings[] = {"", "train.epochs=3", "train.borrow=off"};
    std::set<std::string> files, hashes;
    for (std::size_t n = 0; n < 3; ++n) {
        const Outcome o = train(std::string("@room.gltf --quiet --cache @cache --json @t.json") +
                                kSmall + options[n]);
        ASSERT_EQ(o.exitCode, 0) << o.err;
        const nlohmann::json j = json("t.json");
        files.insert(trainedFile());
        hashes.insert(j.at("content_hash"));
        const std::string set = *settings[n] ? std::string(" --set ") + settings[n] : "";
        const Outcome rendered = run(render() + " --quiet --json @out.json" + set);
        ASSERT_EQ(rendered.exitCode, 0) << rendered.err;
        EXPECT_EQ(json("out.json").at("cache_hashes").at("subspaces"), j.at("content_hash"));
    }
    EXPECT_EQ(files.size(), 3u);
    EXPECT_EQ(hashes.size(), 3u);
}

TEST_F(TrainTool, CachesThatAreNotThisScenesExitWith3) {
    expectFailure(render() + " --quiet", 3, "--prepare");
    const std::string arguments = std::string("@room.gltf --quiet --cache @cache --json @t.json");
    ASSERT_EQ(train(arguments + kSmall).exitCode, 0);
    const std::string file = trainedFile();
    const std::string good = read(std::filesystem::relative(file, path("")).string());
    ASSERT_GT(good.size(), 1000u);
    const auto refused = [&](const std::string& bytes, const char* what) {
        std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
        SCOPED_TRACE(what);
        expectFailure(render() + " --quiet", 3, "--prepare");
    };
    refused(good.substr(0, good.size() / 2), "truncated");
    refused("", "empty");
    std::string bad = good;
    bad[good.size() / 3] = char(bad[good.size() / 3] ^ 4);
    refused(bad, "flipped");
    bad = good;
    bad[8] = 0;  // the version
    refused(bad, "of an older version");

    TinyScene other;
    other.pointLight = true;
    write("other.gltf", other.text());
    ASSERT_EQ(train("@other.gltf --quiet -o " + file + kSmall).exitCode, 0);
    expectFailure(render() + " --quiet", 3, "--prepare");

    EXPECT_EQ(run(render() + " --quiet --prepare").exitCode, 0);
    EXPECT_EQ(run(render() + " --quiet").exitCode, 0);
}

TEST_F(TrainTool, InterruptWritesNothing) {
    const Outcome o = runAndSignal(
        "@room.gltf --cache @cache --light-paths 1000000000 --paths 1000 "
        "--subspaces 10",
        {SIGINT}, std::chrono::milliseconds(700), LACUNA_TRAIN);
    EXPECT_EQ(o.exitCode, 130) << o.err;
    EXPECT_NE(o.err.find("nothing was written"), std::string::npos) << o.err;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path(""))) {
        EXPECT_NE(entry.path().extension(), ".subspaces");
        EXPECT_NE(entry.path().extension(), ".tmp");
    }
}

/// Little or nothing to learn from: training ends, and the picture is right all the same.
TEST_F(TrainTool, DegenerateScenesAndSettings) {
    TinyScene dark;
    dark.lamp = false;
    write("dark.gltf", dark.text());
    const Outcome nothing = train(std::string("@dark.gltf --cache @cache --json @t.json") + kSmall);
    EXPECT_EQ(nothing.exitCode, 0) << nothing.err;
    EXPECT_NE(nothing.err.find("nothing was learned"), std::string::npos) << nothing.err;
    EXPECT_EQ(json("t.json").at("paths"), 0);

    // The lamp's ceiling and a wall face each other: the mean is known from bpt.
    const std::string size = " --quiet --width 8 --height 6 --max-depth 3 --json @out.json ";
    ASSERT_EQ(run("@room.gltf -o @out.exr --method bpt --iterations 2000" + size).exitCode, 0);
    const double mean = json("out.json")["mean_rgb"][1];
    const double error = json("out.json")["mean_rgb_stderr"][1];
    const char* degenerate[] = {"train.paths=1", "train.subspaces=1", "train.light_paths=1",
                                "train.epochs=0"};
    for (const std::string setting : degenerate) {
        const std::string key = setting.substr(0, setting.find('='));
        std::string settings = " --set " + setting;
        for (const char* rest : {"train.paths=500", "train.subspaces=9", "train.light_paths=500"}) {
            if (std::string(rest).rfind(key, 0) != 0) settings += std::string(" --set ") + rest;
        }
        const Outcome o =
            run("@room.gltf -o @out.exr --method spcbpt --prepare --cache @cache "
                "--iterations 1000 --set candidates=50" +
                settings + size);
        ASSERT_EQ(o.exitCode, 0) << setting << o.err;
        const nlohmann::json j = json("out.json");
        // 5 standard errors: 6e-7 false alarms.
        const double both = std::hypot(error, j["mean_rgb_stderr"][1].get<double>());
        EXPECT_NEAR(j["mean_rgb"][1].get<double>(), mean, 5 * both) << setting;
        EXPECT_EQ(j["invalid_samples"], 0) << setting;
    }
}

class TrainToolSlow : public TrainTool {};

TEST_F(TrainToolSlow, TreesOfTheDoorAreAccurate) {
    const Outcome o = train(std::string(LACUNA_SCENES "/door.glb --quiet --cache @cache --json ") +
                            "@t.json --paths 200000 --light-paths 20000");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const nlohmann::json j = json("t.json");
    EXPECT_GE(j.at("light_tree").at("held_out_accuracy"), 0.8);
    EXPECT_GE(j.at("eye_tree").at("held_out_accuracy"), 0.8);
    EXPECT_LE(j.at("gamma").at("held_out_loss"), j.at("gamma").at("held_out_loss_full"));
}

}  // namespace
}  // namespace lacuna::test
