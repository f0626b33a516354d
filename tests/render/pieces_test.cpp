// Pictures that are rendered in pieces: --checkpoint, --blocks and lacuna-merge. Such a picture is
// the same as one that is rendered in one go, bit for bit.
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "libcore/image/exr.h"
#include "libcore/methods/registry.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

using std::chrono::milliseconds;

class RenderPieces : public RenderTool {
  protected:
    Outcome merge(const std::string& arguments) const { return run(arguments, LACUNA_MERGE); }

    std::string bytes(const std::string& name) const { return read(name); }
};

std::vector<std::string> allMethods() {
    std::vector<std::string> names;
    for (const MethodRow& row : methods()) names.push_back(row.name);
    return names;
}

class RenderPiecesOf : public RenderPieces, public ::testing::WithParamInterface<std::string> {};

TEST_P(RenderPiecesOf, mergedPartsAreThePicture) {
    // Ten iterations: the last block is incomplete.
    const std::string common =
        quick(GetParam(),
              "--quiet --techniques --light-noise --layer 'x=C<.D>.*' --iterations 10 "
              "--sampler sobol "
              "--block-iterations 4");
    const auto to = [&](const std::string& name) {
        std::string text = common;
        return text.replace(text.find("@out.exr"), 8, "@" + name);
    };
    ASSERT_EQ(run(to("whole.exr")).exitCode, 0);
    ASSERT_EQ(run(to("a.exr") + " --blocks 0,1").exitCode, 0);
    ASSERT_EQ(run(to("b.exr") + " --blocks 1,7").exitCode, 0);
    const Outcome o = merge("@b.exr @a.exr -o @merged.exr --json @m.json");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    expectSamePicture("merged.exr", "whole.exr");
    EXPECT_EQ(json("m.json")["blocks"], 3);
    EXPECT_EQ(json("m.json")["iterations"], 10);
    EXPECT_GT(json("m.json")["mean_rgb_stderr"][1], 0.0);
}

TEST_P(RenderPiecesOf, moreIterationsGoOnFromTheCheckpoint) {
    const auto command = [&](int iterations, const std::string& more) {
        // Blocks of 12 and checkpoints cut groups of 8.
        return quick(GetParam(),
                     "--quiet --sampler sobol --block-iterations 12 --json @o.json "
                     "--iterations " +
                         std::to_string(iterations) + " " + more);
    };
    ASSERT_EQ(run(command(14, "")).exitCode, 0);
    const nlohmann::json whole = json("o.json");
    std::filesystem::rename(path("out.exr"), path("whole.exr"));
    for (const int iterations : {2, 6, 9, 13, 14, 14}) {
        const Outcome o = run(command(iterations, "--checkpoint @ck"));
        ASSERT_EQ(o.exitCode, 0) << o.err;
    }
    expectSamePicture("out.exr", "whole.exr");
    // The checkpoint has more iterations than this command asks for, so its picture is another one.
    const Outcome fewer = run(command(4, "--checkpoint @ck"));
    EXPECT_EQ(fewer.exitCode, 3);
    EXPECT_NE(fewer.err.find("at most 4 iterations"), std::string::npos) << fewer.err;
    ASSERT_EQ(run(command(14, "--checkpoint @ck")).exitCode, 0);
    for (const char* key : {"rays_by_kind", "mean_rgb", "mean_rgb_stderr", "iterations"}) {
        EXPECT_EQ(json("o.json")[key], whole[key]) << key;
    }
}

INSTANTIATE_TEST_SUITE_P(All, RenderPiecesOf, ::testing::ValuesIn(allMethods()),
                         [](const auto& test) {
                             std::string name = test.param;
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

class RenderKills : public RenderPieces {
  protected:
    /// Kills `method` at `kills` random moments, then lets it end. On a machine that became busier,
    /// every kill may come before the first save; then later moments are tried until one comes
    /// after it.
    void killAndGoOn(const std::string& method, int kills, std::uint64_t seed) {
        SCOPED_TRACE(method);
        const std::string common =
            quick(method, "--quiet --width 32 --height 24 --iterations 80 --block-iterations 8");
        const auto start = std::chrono::steady_clock::now();
        ASSERT_EQ(run(common).exitCode, 0);
        double whole =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        std::filesystem::rename(path("out.exr"), path("whole.exr"));
        std::filesystem::remove(path("ck"));
        std::mt19937_64 random(seed);
        int resumed = 0;
        constexpr int kMostTries = 20;
        for (int i = 0; i < kills || (resumed == 0 && i < kMostTries); ++i) {
            const auto delay = milliseconds(int(whole * double(random() % 800 + 100)));
            runAndSignal(common + " --checkpoint @ck --checkpoint-every 0.01s", {SIGKILL}, delay);
            if (!exists("ck")) {
                whole *= 1.25;
                continue;
            }
            ++resumed;
            EXPECT_NO_THROW(readExrLayers(path("ck")));
        }
        EXPECT_GT(resumed, 0);
        const Outcome o = run(common + " --checkpoint @ck");
        ASSERT_EQ(o.exitCode, 0) << o.err;
        expectSamePicture("out.exr", "whole.exr");
        EXPECT_TRUE(temporaries().empty());
    }
};

TEST_F(RenderKills, leaveNothingToBeSeen) {
    for (const char* method : {"bpt", "lvcbpt", "icbpt", "skelbpt", "spcbpt"}) {
        killAndGoOn(method, 1, 3);
    }
}

using RenderKillsNight = RenderKills;

/// A hundred kills, over all rows.
TEST_F(RenderKillsNight, leaveNothingToBeSeenByAnyRow) {
    const std::vector<std::string> names = allMethods();
    const int each = (100 + int(names.size()) - 1) / int(names.size());
    for (const std::string& method : names) killAndGoOn(method, each, 7);
}

TEST_F(RenderKills, anInterruptSavesTheCheckpoint) {
    for (const char* method : {"bpt", "tsrbpt"}) {
        SCOPED_TRACE(method);
        // tsrbpt saves whole blocks. By then there is one, even on a busy machine.
        const std::string more = "--block-iterations 2 --width 48 --height 32 --quiet";
        const Outcome o =
            runAndSignal(quick(method, more + " --time 1h --iterations 100000 --checkpoint @ck"),
                         {SIGINT}, milliseconds(1500));
        EXPECT_EQ(o.exitCode, 130) << o.err;
        ASSERT_TRUE(exists("ck"));
        const int done = std::get<int>(readExrLayers(path("out.exr")).attributes.at("iterations"));
        const std::string end = quick(method, more + " --iterations " + std::to_string(done + 5));
        ASSERT_EQ(run(end + " --checkpoint @ck").exitCode, 0);
        std::filesystem::rename(path("out.exr"), path("resumed.exr"));
        ASSERT_EQ(run(end).exitCode, 0);
        expectSamePicture("resumed.exr", "out.exr");
        std::filesystem::remove(path("ck"));
    }
}

TEST_F(RenderPieces, theCurveGoesOnToo) {
    const auto command = [&](const std::string& iterations) {
        return quick("bpt",
                     "--quiet --checkpoint @ck --log @o.csv --block-iterations 4 "
                     "--iterations " +
                         iterations);
    };
    ASSERT_EQ(run(command("3")).exitCode, 0);
    const std::string before = read("o.csv");
    ASSERT_EQ(run(command("9")).exitCode, 0);
    const std::string after = read("o.csv");
    EXPECT_EQ(after.substr(0, before.size()), before);
    EXPECT_NE(after.find("\n9,"), std::string::npos) << after;
    // Rows after the checkpoint belong to iterations that are rendered again.
    std::ofstream(path("o.csv"), std::ios::app) << "77,9e9,0,0,,,,\n";
    ASSERT_EQ(run(command("11")).exitCode, 0);
    EXPECT_EQ(read("o.csv").find("\n77,"), std::string::npos);
}

TEST_F(RenderPieces, otherCommandsAreRefused) {
    const std::string common = quick("lvcbpt", "--quiet --checkpoint @ck --block-iterations 4");
    ASSERT_EQ(run(common).exitCode, 0);
    const std::string before = bytes("ck");
    const std::pair<const char*, const char*> others[] = {
        {" --seed 2", "seed (there '1', here '2')"},
        {" --set connections=2", "connections (there '3', here '2')"},
        {" --set candidates=101", "candidates"},
        {" --crop 0,8,0,8", "crop"},
        {" --techniques", "technique layers"},
        {" --light-groups", "layers of light groups"},
        {" --light-noise", "layers of light groups (there 'no', here 'yes, with their noise')"},
        {" --units photometric", "lamp units"},
        {" --layer x=CL", "layers of expressions (there '', here 'x')"},
        {" --rr-depth 2", "roulette depth"},
    };
    for (const auto& [more, part] : others) expectFailure(common + more, 3, part);
    const auto layered = [&](const std::string& layers) {
        return quick("lvcbpt", "--quiet --checkpoint @layered --block-iterations 1 " + layers);
    };
    ASSERT_EQ(run(layered("--layer x=CL --layer y=CDL")).exitCode, 0);
    EXPECT_EQ(run(layered("--layer y=CDL --layer x=CL")).exitCode, 0);
    expectFailure(layered("--layer x=CL --layer y=CGL"), 3, "layer y (there 'CDL', here 'CGL')");
    expectFailure(layered("--layer x=CL"), 3, "layers of expressions (there 'x y', here 'x')");
    std::string text = common;
    expectFailure(text.replace(text.find("--block-iterations 4"), 20, "--block-iterations 8"), 3,
                  "iterations of a block (there '4', here '8')");
    expectFailure(
        quick("lvcbpt",
              "--quiet --checkpoint @ck --block-iterations 4 --blocks 1,2 --iterations 8"),
        3, "first block (there 0, here 1)");
    // Another scene under the same name.
    TinyScene other;
    other.pointLight = true;
    write("room.gltf", other.text());
    expectFailure(common, 3, "scene (of another content)");
    EXPECT_TRUE(bytes("ck") == before);
}

TEST_F(RenderPieces, damagedAndForeignFilesAreRefusedAndKept) {
    const std::string common = quick("bpt", "--quiet --checkpoint @ck");
    ASSERT_EQ(run(common).exitCode, 0);
    const std::string whole = bytes("ck");
    std::mt19937_64 random(11);
    std::vector<std::string> files{"",
                                   "hello",
                                   whole.substr(0, whole.size() / 2),
                                   whole.substr(0, whole.size() - 1),
                                   whole + "x",
                                   read("room.gltf"),
                                   bytes("out.exr")};
    for (int i = 0; i < 40; ++i) {
        std::string flipped = whole;
        flipped[random() % flipped.size()] ^= char(1 << random() % 8);
        files.push_back(flipped);
    }
    int refused = 0;
    for (const std::string& text : files) {
        write("ck", text);
        const Outcome o = run(common);
        if (o.exitCode == 0) continue;  // this bit has no meaning
        ++refused;
        EXPECT_EQ(o.exitCode, 3) << o.err;
        EXPECT_NE(o.err.find(path("ck")), std::string::npos) << o.err;
        EXPECT_TRUE(bytes("ck") == text) << "overwritten";
    }
    // Words that OpenEXR skips and bytes after the end change nothing.
    EXPECT_GE(refused, int(files.size()) - 4);
}

TEST_F(RenderPieces, aFullDiskCostsTheNewCheckpointAndNothingElse) {
    const auto command = [&](const std::string& more) {
        std::string text = quick("bpt", "--checkpoint @ck --json @o.json " + more);
        return text.replace(text.find("@out.exr"), 8, "@out.png");
    };
    ASSERT_EQ(run(command("--iterations 8 --quiet")).exitCode, 0);
    const std::string before = bytes("ck");
    // Files may have 8 kB: the picture fits, a checkpoint does not.
    const std::string tool =
        std::string("sh -c 'ulimit -f 16; trap \"\" XFSZ; exec \"$0\" \"$@\"' ") + LACUNA_RENDER;
    const Outcome o = run(command("--iterations 60 --checkpoint-every 0.001s"), tool.c_str());
    EXPECT_EQ(o.exitCode, 1) << o.err;
    EXPECT_NE(o.err.find("the render goes on"), std::string::npos) << o.err;
    EXPECT_NE(o.err.find(path("ck")), std::string::npos) << o.err;
    EXPECT_TRUE(bytes("ck") == before);
    EXPECT_EQ(json("o.json")["iterations"], 60);
    EXPECT_TRUE(temporaries().empty());
}

/// A save takes long on such a disk. The render goes on meanwhile, and a kill during a save leaves
/// the last file.
TEST_F(RenderKills, onASlowDiskCostNeitherPictureNorCheckpoint) {
    if (LACUNA_SANITIZED) GTEST_SKIP() << "a sanitizer must be loaded first";
    const auto command = [&](const std::string& more) {
        return quick("bpt", "--quiet --width 64 --height 48 --block-iterations 8 " + more);
    };
    ASSERT_EQ(run(command("--iterations 120")).exitCode, 0);
    std::filesystem::rename(path("out.exr"), path("whole.exr"));
    const std::string saving = "--checkpoint @ck --checkpoint-every 0.001s ";
    ASSERT_EQ(run(command(saving + "--iterations 3")).exitCode, 0);
    const std::string tool =
        std::string("env LD_PRELOAD=") + LACUNA_SLOW_DISK + " " + LACUNA_RENDER;
    for (int i = 0; i < 3; ++i) {
        runAndSignal(command(saving + "--iterations 120"), {SIGKILL}, milliseconds(250 + 150 * i),
                     tool.c_str());
        EXPECT_NO_THROW(readExrLayers(path("ck")));
    }
    const Outcome o = run(command(saving + "--iterations 120"), tool.c_str());
    ASSERT_EQ(o.exitCode, 0) << o.err;
    expectSamePicture("out.exr", "whole.exr");
    EXPECT_TRUE(temporaries().empty());
}

TEST_F(RenderPieces, partsThatDoNotFitAreRefused) {
    const std::string common = quick("bpt", "--quiet --block-iterations 2 --iterations 12");
    const auto part = [&](const std::string& name, const std::string& more) {
        std::string text = common + " " + more;
        ASSERT_EQ(run(text.replace(text.find("@out.exr"), 8, "@" + name)).exitCode, 0);
    };
    part("a.exr", "--blocks 0,2");
    part("b.exr", "--blocks 2,4");
    part("c.exr", "--blocks 4,6");
    part("overlap.exr", "--blocks 3,6");
    part("seed.exr", "--blocks 2,4 --seed 2");
    part("whole.exr", "");
    const auto refuse = [&](const std::string& parts, const std::string& text) {
        expectFailure(parts + " -o @no.exr", 3, text, LACUNA_MERGE);
        EXPECT_FALSE(exists("no.exr"));
    };
    refuse("@a.exr @b.exr @overlap.exr", "overlap.exr: expected blocks behind those of");
    refuse("@a.exr @a.exr", "leave one of the two out");
    refuse("@a.exr @c.exr", "expected block 2 to be next, found block 4");
    refuse("@b.exr @c.exr", "expected block 0 to be first");
    refuse("@a.exr @seed.exr", "seed (there '2', here '1')");
    refuse("@a.exr @whole.exr", "found an image without its sums");
    refuse("@a.exr @nowhere.exr", "nowhere.exr");

    // With --gaps, the existing parts are merged, with their own error.
    const Outcome o = merge("@c.exr @a.exr -o @m.exr --gaps --json @m.json");
    EXPECT_EQ(o.exitCode, 0);
    EXPECT_NE(o.err.find("expected block 2 to be next"), std::string::npos) << o.err;
    EXPECT_EQ(json("m.json")["iterations"], 8);
    EXPECT_EQ(json("m.json")["blocks"], 4);
    const auto mean = [&](const std::string& name) {
        double sum = 0.0;
        const LayeredImage image = readExrLayers(path(name));
        for (const float v : *image.find("G")) sum += double(v);
        return sum;
    };
    EXPECT_NEAR(mean("m.exr"), 0.5 * (mean("a.exr") + mean("c.exr")), 1e-4 * mean("a.exr"));

    // A part that was interrupted within a block.
    std::string text = quick("bpt", "--quiet --block-iterations 2 --iterations 3 --blocks 0,2");
    ASSERT_EQ(run(text.replace(text.find("@out.exr"), 8, "@short.exr")).exitCode, 0);
    refuse("@short.exr @b.exr", "found block 1 unfinished");
    ASSERT_EQ(merge("@short.exr @b.exr -o @m.exr --gaps --json @m.json").exitCode, 0);
    EXPECT_EQ(json("m.json")["iterations"], 7);
}

TEST_F(RenderPieces, optionsThatDoNotGoTogetherAreUsageErrors) {
    expectFailure(quick("bpt", "--blocks 0,1 --time 5s"), 2, "--blocks");
    expectFailure(quick("bpt", "--blocks 0,1 --verify"), 2, "--verify");
    expectFailure(quick("bpt", "--checkpoint @ck --verify"), 2, "--verify");
    expectFailure(quick("bpt", "--checkpoint-every 5s"), 2, "--checkpoint FILE");
    expectFailure(quick("bpt", "--checkpoint @ck --checkpoint-every 0"), 2, "--checkpoint-every");
    expectFailure(quick("bpt", "--block-iterations 0"), 2, "--block-iterations");
    for (const char* text : {"3", "1,1", "2,1", "-1,2", "a,b", "0,1,2", "1,", "0,99999999999"}) {
        expectFailure(quick("bpt", std::string("--blocks ") + text), 2, "--blocks");
    }
    // Two iterations are one block.
    expectFailure(quick("bpt", "--blocks 1,2"), 2, "blocks below 1 (2 iterations, 64 to a block)");
    expectFailure(quick("bpt", "--checkpoint @room.gltf"), 2, "found the scene");
    expectFailure(quick("bpt", "--checkpoint @no/such/directory"), 1, "no/such/directory");
    expectFailure("@a.exr", 2, "-o", LACUNA_MERGE);
    expectFailure("@a.exr -o @a.exr", 2, "found a part", LACUNA_MERGE);
    expectFailure("@a.exr -o @m.png", 2, ".exr", LACUNA_MERGE);
}

/// A replayed sample of a later block is the one that the block contains.
TEST_F(RenderPieces, replaysAreOfTheirBlock) {
    for (const MethodRow& row : methods()) {
        const auto method = row.create(resolve(row, {}));
        if (row.techniques.splats || !method->learns() || !needsOf(row, resolve(row, {})).empty())
            continue;
        SCOPED_TRACE(row.name);
        // Iteration 3 alone is block 3 of blocks of one iteration.
        const std::string common = quick(row.name, "--quiet --block-iterations 1 --iterations 4");
        ASSERT_EQ(run(common + " --blocks 3,4").exitCode, 0);
        const LayeredImage image = readExrLayers(path("out.exr"));
        const Outcome o = run(common + " --replay 5,9,3");
        ASSERT_EQ(o.exitCode, 0) << o.err;
        const std::size_t total = o.out.find("total: ");
        ASSERT_NE(total, std::string::npos);
        double r = -1.0;
        ASSERT_EQ(std::sscanf(o.out.c_str() + total, "total: %*d contributions, %lf", &r), 1);
        EXPECT_NEAR(r, double((*image.find("R"))[9 * 24 + 5]), 1e-5 * std::fabs(r));
    }
}

}  // namespace
}  // namespace lacuna::test
