// Output, files and exit codes of lacuna-train, and how lacuna-render uses its files.
#include <signal.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include "libcore/image/image_io.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

/// An environment of constant radiance.
void writeSky(const std::string& path, float radiance) {
    LayeredImage sky(8, 4);
    for (const char* channel : {"R", "G", "B"}) std::ranges::fill(sky.channel(channel), radiance);
    writeImage(path, sky);
}

class TrainTool : public RenderTool {
  protected:
    /// Includes the shape of the picture, which is an input of training.
    static constexpr const char* kSmall =
        " --paths 5000 --subspaces 50 --light-paths 5000 --width 24 --height 16";
    static constexpr const char* kSameSmall =
        "--set train.paths=5000 --set train.subspaces=50 --set train.light_paths=5000";

    Outcome train(const std::string& arguments) const { return run(arguments, LACUNA_TRAIN); }
    /// The file that the last training reported in --json @t.json.
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
    EXPECT_LE(gamma.at("held_out_loss"), gamma.at("held_out_loss_full"));
    EXPECT_EQ(gamma.at("train_loss_by_epoch").size(), gamma.at("held_out_loss_by_epoch").size());
    EXPECT_EQ(j.at("subspaces"), 50);
    EXPECT_LE(j.at("light_subspaces"), 50);
    // Approximate: the number of iterations is estimated from the paths of the first one.
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

/// Columns that borrow from their neighbours lower the held-out loss, and may raise the loss of the
/// training paths. Without borrowing, every step lowers the training loss.
TEST_F(TrainTool, WithoutBorrowingTheTrainingLossOnlyFalls) {
    const Outcome o = train(
        std::string("@room.gltf --cache @cache --borrow off --json @t.json --quiet") + kSmall);
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const nlohmann::json gamma = json("t.json").at("gamma");
    const auto losses = gamma.at("train_loss_by_epoch").get<std::vector<double>>();
    ASSERT_GT(losses.size(), 1u);
    EXPECT_EQ(losses.front(), gamma.at("train_loss_full"));
    EXPECT_LT(losses.back(), losses.front());
    EXPECT_TRUE(std::ranges::is_sorted(losses, std::greater<>()));
    EXPECT_LE(gamma.at("train_loss"), gamma.at("train_loss_full"));
    EXPECT_LE(gamma.at("held_out_loss"), gamma.at("held_out_loss_full"));
}

/// In the door scene, where emission is worth learning.
TEST_F(TrainTool, EmissionIsLearnedFirstAndFollowed) {
    const std::string scene = LACUNA_SCENES "/door.glb --cache @cache ";
    const std::string small = "--width 24 --height 16 --quiet ";
    const Outcome o = train(scene + small + "--paths 20000 --subspaces 50 --light-paths 5000 " +
                            "--json @t.json");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const nlohmann::json emission = json("t.json").at("emission");
    EXPECT_TRUE(emission.at("learned"));
    EXPECT_NEAR(emission.at("paths").get<double>(), 10000, 2500);
    EXPECT_LT(emission.at("held_out_loss"), 0.85);
    EXPECT_GT(emission.at("ray_trees"), 0);
    EXPECT_TRUE(std::filesystem::exists(emission.at("file").get<std::string>()));
    EXPECT_NE(o.out.find("emission: second moment"), std::string::npos) << o.out;

    // Methods that ask for the guide find it; other methods do not use it.
    const std::string render = scene + small + "--iterations 2 -o @out.exr --json @out.json ";
    const std::string learned = "--set emission=learned --set emission_paths=10000 ";
    const auto hash = [&](const std::string& name) {
        return json("out.json").at("cache_hashes").at(name).get<std::string>();
    };
    ASSERT_EQ(run(render + "--method spcbpt --set train.paths=20000 --set train.subspaces=50 "
                           "--set train.light_paths=5000 --verify")
                  .exitCode,
              0);
    EXPECT_LT(json("out.json").at("verify").at("max_difference"), 1e-6);
    const std::string guide = hash("emission");
    ASSERT_EQ(run(render + "--method bpt --verify " + learned).exitCode, 0);
    EXPECT_EQ(hash("emission"), guide);
    EXPECT_LT(json("out.json").at("verify").at("max_difference"), 1e-6);
    ASSERT_EQ(run(render + "--method bpt").exitCode, 0);
    EXPECT_TRUE(json("out.json").at("cache_hashes").empty());
    expectFailure(render + "--method bpt --set emission=learned --set emission_paths=77", 3,
                  "add --prepare");
    expectFailure(render + "--method pt --set emission=learned", 2, "emission");
}

/// Also in the door scene, where eye walks alone find little light. Each row learns a guide for its
/// own techniques.
TEST_F(TrainTool, WalksAreLearnedAndFollowed) {
    const std::string scene = LACUNA_SCENES "/door.glb --cache @cache ";
    const std::string small = "--width 24 --height 16 --quiet ";
    const Outcome o = train(scene + small + "--walks guided --walk-paths 20000 --paths 5000 " +
                            "--subspaces 50 --light-paths 5000 --json @t.json");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const nlohmann::json walks = json("t.json").at("walks");
    EXPECT_NEAR(walks.at("paths").get<double>(), 20000, 5000);
    EXPECT_TRUE(walks.at("guided"));
    EXPECT_LT(walks.at("held_out_loss").at("light"), 0.97);
    EXPECT_TRUE(std::filesystem::exists(walks.at("file").get<std::string>()));
    EXPECT_NE(o.out.find("walks: second moment"), std::string::npos) << o.out;

    const std::string render =
        scene + small + "--iterations 2 -o @out.exr --json @out.json --verify ";
    const std::string guided = "--set walks=guided --set walk_paths=20000 ";
    const auto rendered = [&](const std::string& more) {
        const Outcome r = run(render + guided + more);
        EXPECT_EQ(r.exitCode, 0) << r.err;
        EXPECT_LT(json("out.json").at("verify").at("max_difference"), 1e-6);
        return json("out.json").at("cache_hashes").at("walks").get<std::string>();
    };
    rendered(
        "--method spcbpt --set train.paths=5000 --set train.subspaces=50 "
        "--set train.light_paths=5000");
    expectFailure(render + guided + "--method pt", 3, "add --prepare");
    const std::string ofPt = rendered("--method pt --prepare");
    EXPECT_NE(rendered("--method bpt --prepare"), ofPt);
    EXPECT_EQ(rendered("--method pt"), ofPt);
}

/// Subspaces that were trained with one emission are refused with another.
TEST_F(TrainTool, SubspacesBelongToTheirEmission) {
    const std::string scene = LACUNA_SCENES "/door.glb --quiet --cache @cache ";
    const std::string shape = "--width 24 --height 16 ";
    ASSERT_EQ(train(scene + shape +
                    "--emission plain --paths 5000 --subspaces 50 "
                    "--light-paths 5000 --json @t.json")
                  .exitCode,
              0);
    EXPECT_TRUE(json("t.json").at("emission").is_null());
    const std::string render =
        scene + shape + "--iterations 1 -o @out.exr --method spcbpt " + std::string(kSameSmall);
    EXPECT_EQ(run(render + " --set emission=plain").exitCode, 0);
    expectFailure(render, 3, "--paths 5000");
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

/// Another setting gives another file with another content. The renderer finds it by the same
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

/// A cache depends on all inputs of training: the environment, the effects, the camera, its lens,
/// the longest paths.
TEST_F(TrainTool, CachesOfOtherInputsAreRefusedByName) {
    ASSERT_EQ(run(render() + " --quiet --prepare").exitCode, 0);
    ASSERT_EQ(run(render() + " --quiet").exitCode, 0);
    writeSky(path("sky.exr"), 1.0f);
    const std::pair<const char*, const char*> cases[] = {
        {" --env @sky.exr", "environment (there 'none', here one)"},
        {" --effect area_lights=off",
         "effects (there 'as the scene calls for', here 'area_lights=off')"},
        {" --env-colour 0,0.5,1", "here 'colour 0 0.5 1')"},
        {" --aperture 0.01 --focus 2", "lens (there 'pinhole', here 'radius"},
        {" --shift 0.1,-0.25", "here 'pinhole shift 0.1 -0.25')"},
        {" --max-depth 5", "max depth (there '12', here '5')"},
        {" --rr-depth 2", "roulette depth (there '3', here '2')"},
        {" --tolerance 0.01", "tolerance (there '0', here '0.01')"},
        {" --units photometric", "lamp units (there 'radiometric', here 'photometric')"},
        {" --set train.epochs=3", "epochs (there '20', here '3')"},
    };
    for (const auto& [options, difference] : cases) {
        SCOPED_TRACE(options);
        const Outcome o = run(render() + options + " --quiet");
        EXPECT_EQ(o.exitCode, 3) << o.err;
        EXPECT_NE(o.err.find(difference), std::string::npos) << o.err;
        EXPECT_NE(o.err.find("lacuna-train"), std::string::npos) << o.err;
        EXPECT_EQ(run(render() + options + " --quiet --prepare").exitCode, 0);
        EXPECT_EQ(run(render() + options + " --quiet").exitCode, 0);
    }
    // The same environment with another scale, and another content under the same name.
    ASSERT_EQ(run(render() + " --env @sky.exr --quiet").exitCode, 0);
    expectFailure(render() + " --env @sky.exr --env-scale 2 --quiet", 3, "environment scale");
    writeSky(path("sky.exr"), 2.0f);
    expectFailure(render() + " --env @sky.exr --quiet", 3, "environment (");
}

/// The empty space and its skeleton depend on the scene alone, not on the camera.
TEST_F(TrainTool, SkeletonsOfOtherScenesAreRefusedByName) {
    const std::string skelbpt =
        "@room.gltf -o @out.exr --method skelbpt --iterations 1 --cache @cache --quiet --set "
        "candidates=100 --set voxels.resolution=16 --width 24 --height 16";
    ASSERT_EQ(run(skelbpt + " --prepare").exitCode, 0);
    for (const char* same : {" --max-depth 5", " --aperture 0.01 --focus 2", " --seed 3"}) {
        EXPECT_EQ(run(skelbpt + same).exitCode, 0) << same;
    }
    for (const auto& [options, difference] :
         {std::pair(" --effect area_lights=off", "effects (there"),
          std::pair(" --set voxels.resolution=17", "resolution (there '16', here '17')"),
          std::pair(" --tolerance 0.01", "tolerance (there '0', here '0.01')")}) {
        const Outcome o = run(skelbpt + options);
        EXPECT_EQ(o.exitCode, 3) << options;
        EXPECT_NE(o.err.find(difference), std::string::npos) << o.err;
        EXPECT_NE(o.err.find("lacuna-skeletonize"), std::string::npos) << o.err;
    }
}

/// The command in the refusal makes the missing cache. The picture's aspect ratio is an input, its
/// size in pixels is not.
TEST_F(TrainTool, TheNamedCommandMakesTheCache) {
    const std::string small = " --paths 5000 --subspaces 50 --light-paths 5000";
    const Outcome refused = run(render() + " --max-depth 4 --quiet");
    ASSERT_EQ(refused.exitCode, 3);
    const std::size_t begin = refused.err.find("run lacuna-train");
    ASSERT_NE(begin, std::string::npos) << refused.err;
    std::string command = refused.err.substr(begin + std::string("run lacuna-train").size());
    command.resize(command.find_last_not_of(" \n") + 1);
    for (const char* part :
         {"--paths 5000", "--max-depth 4", "--width 24", "--height 16", "--cache"}) {
        EXPECT_NE(command.find(part), std::string::npos) << command;
    }
    EXPECT_EQ(command.find("--epochs"), std::string::npos) << command;  // the default
    ASSERT_EQ(train(command + " --quiet").exitCode, 0);
    EXPECT_EQ(run(render() + " --max-depth 4 --quiet").exitCode, 0);
    std::string twice = render() + " --max-depth 4 --quiet";
    twice.replace(twice.find("--width 24 --height 16"), 22, "--width 48 --height 32");
    EXPECT_EQ(run(twice).exitCode, 0);
    twice.replace(twice.find("--height 32"), 11, "--height 24");
    expectFailure(twice, 3, "aspect");
}

/// Training uses the camera that is rendered.
TEST_F(TrainTool, TrainingLooksThroughTheChosenCamera) {
    TinyScene two;
    nlohmann::json scene = nlohmann::json::parse(two.text());
    std::size_t node = 0;
    while (!scene["nodes"][node].contains("camera")) ++node;
    scene["cameras"][0]["name"] = "front";
    nlohmann::json other = scene["cameras"][0];
    other["name"] = "close";
    scene["cameras"].push_back(other);
    nlohmann::json place = scene["nodes"][node];
    place["camera"] = 1;
    place["translation"] = {0.0, 0.0, 1.0};
    scene["nodes"].push_back(place);
    scene["scenes"][0]["nodes"].push_back(scene["nodes"].size() - 1);
    write("room.gltf", scene.dump());
    std::set<std::string> hashes;
    for (const char* camera : {"", " --camera front", " --camera close"}) {
        const Outcome o = run(render() + camera + " --quiet --prepare --json @out.json");
        ASSERT_EQ(o.exitCode, 0) << o.err;
        hashes.insert(json("out.json").at("cache_hashes").at("subspaces"));
    }
    EXPECT_EQ(hashes.size(), 2u);  // the first is the default
}

using TrainToolInterrupt = TrainTool;

/// An interrupted --prepare leaves no half-made cache and makes no picture.
TEST_F(TrainToolInterrupt, WhilePreparingPromisesNothing) {
    const Outcome o = runAndSignal(
        "@room.gltf -o @out.exr --method spcbpt --prepare --cache @cache "
        "--set train.light_paths=1000000000 --set train.paths=1000 --set train.subspaces=10",
        {SIGINT}, std::chrono::milliseconds(700));
    EXPECT_EQ(o.exitCode, 130) << o.err;
    // The immediate answer to the signal may precede this line or not.
    EXPECT_NE(o.err.find("nothing was written"), std::string::npos) << o.err;
    EXPECT_EQ(o.err.find("saved"), std::string::npos) << o.err;
    EXPECT_FALSE(exists("out.exr"));
}

TEST_F(TrainToolInterrupt, WritesNothing) {
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

/// With little or nothing to learn from, training ends, and the picture is right.
TEST_F(TrainTool, DegenerateScenesAndSettings) {
    TinyScene dark;
    dark.lamp = false;
    write("dark.gltf", dark.text());
    const Outcome nothing = train(std::string("@dark.gltf --cache @cache --json @t.json") + kSmall);
    EXPECT_EQ(nothing.exitCode, 0) << nothing.err;
    EXPECT_NE(nothing.err.find("nothing was learned"), std::string::npos) << nothing.err;
    EXPECT_EQ(json("t.json").at("paths"), 0);

    // bpt gives the reference mean.
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
