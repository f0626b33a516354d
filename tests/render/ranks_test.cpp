// Several processes render one picture: mpirun -n P lacuna-render. The picture is that of one
// process, bit for bit, for any number of them and whichever ends too early.
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "libcore/image/exr.h"
#include "libcore/methods/registry.h"
#include "render/ranks/together.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

using std::chrono::milliseconds;

BlockPlan plan(std::uint64_t iterations) {
    BlockPlan p;
    p.iterations = iterations;
    return p;
}

TEST(PieceSize, isANodeOfTheBlocksTree) {
    for (const std::uint64_t block : {1u, 7u, 12u, 64u}) {
        for (const std::uint64_t end : {0u, 100u}) {
            for (std::uint64_t next = 0; next < 100;) {
                const std::uint64_t size = pieceSize(next, end, plan(block), false, 3, 2.0, 0.07);
                ASSERT_GE(size, 1u);
                const std::uint64_t inBlock = next % block;
                EXPECT_EQ(size & (size - 1), 0u);
                EXPECT_EQ(inBlock % size, 0u);
                EXPECT_LE(inBlock + size, block);
                if (end > 0) {
                    EXPECT_LE(next + size, end);
                }
                next += size;
            }
        }
    }
}

TEST(PieceSize, isWhatTheTimeIsWorth) {
    EXPECT_EQ(pieceSize(256, 0, plan(64), false, 4, 2.0, 0.1), 16u);
    EXPECT_EQ(pieceSize(256, 0, plan(64), false, 4, 2.0, 3.0), 1u);
    EXPECT_EQ(pieceSize(256, 0, plan(64), false, 4, -1.0, 0.1), 1u);  // time is over
    EXPECT_EQ(pieceSize(256, 0, plan(64), false, 4, 2.0, 0.0), 1u);   // nothing is known
    EXPECT_EQ(pieceSize(256, 0, plan(64), false, 4, 30.0, 1e-9), 64u);
    // The last iterations are divided among the ranks.
    EXPECT_EQ(pieceSize(32, 64, plan(64), false, 4, 30.0, 0.01), 4u);
}

/// Ranks that stop by the error stop where one process would.
TEST(PieceSize, ofNoneGoesPastACountAtWhichErrorsAreLookedAt) {
    for (std::uint64_t next = 0; next < 1000;) {
        const std::uint64_t end = next + pieceSize(next, 0, plan(4096), false, 2, 30.0, 1e-9);
        for (std::uint64_t n = next + 1; n < end; ++n) ASSERT_FALSE(isMeasured(n)) << n;
        next = end;
    }
}

TEST(PieceSize, isAWholeBlockWhereThatMustBe) {
    EXPECT_EQ(pieceSize(16, 0, plan(16), true, 4, 2.0, 10.0), 16u);
    EXPECT_EQ(pieceSize(96, 100, plan(16), true, 4, 2.0, 10.0), 4u);
}

TEST(Pieces, arriveAsTheyWereSent) {
    const ThreadPool threads(1);
    Part part;
    part.width = 3;
    part.height = 2;
    part.plan = plan(16);
    part.firstBlock = part.sums.openBlock = 5;
    part.seconds = 1.5;
    part.statistics.rays[0] = 7;
    part.statistics.invalidReplays = {"1,2,3"};
    const std::vector<Rgb> pixels{{1, 2, 3}, {4, 5, 6}, {0, 0, 0}, {-1, 0, 1e30f}, {7, 8, 9}, {}};
    SumTree tree(1);
    for (std::uint64_t i = 8; i < 12; ++i) {
        tree.add({i, 1, std::make_shared<FilmSum>(FilmSum::ofIteration(pixels, 3, threads))},
                 nullptr);
    }
    part.sums.open = tree.nodes();
    std::vector<std::byte> bytes = bytesOf(part);
    const Part other = partOf(bytes);
    ASSERT_EQ(other.sums.open.size(), 1u);
    const SumTree::Node &a = part.sums.open[0], &b = other.sums.open[0];
    EXPECT_EQ(b.begin, a.begin);
    EXPECT_EQ(b.size, a.size);
    EXPECT_TRUE(std::ranges::equal(a.sum->mean, b.sum->mean, [](const Rgb& x, const Rgb& y) {
        return x.r == y.r && x.g == y.g && x.b == y.b;
    }));
    EXPECT_EQ(b.sum->wholeMean, a.sum->wholeMean);
    EXPECT_EQ(other.sums.openBlock, 5u);
    EXPECT_EQ(other.statistics.rays, part.statistics.rays);
    EXPECT_EQ(other.statistics.invalidReplays, part.statistics.invalidReplays);
    EXPECT_EQ(other.seconds, 1.5);

    bytes[bytes.size() - 1] ^= std::byte(1);
    EXPECT_THROW(partOf(bytes), RunError);
    bytes.pop_back();
    EXPECT_THROW(partOf(bytes), RunError);
    EXPECT_THROW(partOf({}), RunError);
}

class RenderRanks : public RenderTool {
  protected:
    void SetUp() override {
        RenderTool::SetUp();
        if (std::system("command -v mpirun >/dev/null 2>&1") != 0) {
            GTEST_SKIP() << "expected mpirun (Debian: openmpi-bin), found none";
        }
        if (!LACUNA_HAS_MPI) GTEST_SKIP() << "built with LACUNA_MPI=OFF";
        setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
        setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
        setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // Open MPI's leaks are not ours
    }

    void expectThePictureOfOneProcess(const std::string& method) const;
    Outcome runRanks(int ranks, const std::string& arguments) const {
        return run(arguments, mpirun(ranks).c_str());
    }
    static std::string mpirun(int ranks) {
        // -q, because mpirun prints a dozen lines for every exit code but 0.
        // Shared memory by name, because mpirun takes a second to search for networks.
        return "mpirun -q --oversubscribe --bind-to none --mca btl self,vader --mca pml ob1 -n " +
               std::to_string(ranks) + " " LACUNA_RENDER;
    }
};

/// Starting ranks takes seconds, so only two rows run by day: one that gives out nodes of blocks,
/// one that reads caches.
void RenderRanks::expectThePictureOfOneProcess(const std::string& method) const {
    SCOPED_TRACE(method);
    const std::string common = quick(
        method,
        "--quiet --iterations 10 --sampler sobol --block-iterations 4 --threads 1 --json @o.json");
    for (const std::string layers : {"", " --techniques"}) {
        ASSERT_EQ(run(common + layers).exitCode, 0);
        std::filesystem::rename(path("out.exr"), path("whole.exr"));
        const nlohmann::json whole = json("o.json");
        const Outcome o = runRanks(3, common + layers);
        ASSERT_EQ(o.exitCode, 0) << o.err;
        expectSamePicture("out.exr", "whole.exr");
        const nlohmann::json j = json("o.json");
        EXPECT_EQ(j["ranks"], 3);
        EXPECT_GT(j["received_bytes"], 0);
        for (const char* key : {"rays_by_kind", "mean_rgb", "mean_rgb_stderr", "iterations"}) {
            EXPECT_EQ(j[key], whole[key]) << key;
        }
        // The line and the table are each printed once.
        EXPECT_EQ(o.out.find(" pixels, "), o.out.rfind(" pixels, ")) << o.out;
        EXPECT_EQ(o.out.find("eye vertex"), o.out.rfind("eye vertex")) << o.out;
        EXPECT_LE(std::ranges::count(o.err, '\n'), 1) << o.err;  // a biased row says that it is
    }
}

TEST_F(RenderRanks, makeThePictureOfOneProcess) {
    for (const char* method : {"bpt", "spcbpt"}) expectThePictureOfOneProcess(method);
}

using RenderRanksNight = RenderRanks;

TEST_F(RenderRanksNight, makeThePictureOfOneProcessByEveryRow) {
    for (const MethodRow& row : methods()) expectThePictureOfOneProcess(row.name);
}

TEST_F(RenderRanks, goOnFromACheckpointWithAnotherNumberOfThem) {
    const auto command = [&](const char* method, int iterations) {
        return quick(method,
                     "--quiet --block-iterations 8 --checkpoint @ck --threads 1 "
                     "--iterations " +
                         std::to_string(iterations));
    };
    for (const char* method : {"bpt", "risbpt"}) {
        std::filesystem::remove(path("ck"));
        std::string whole = command(method, 40);
        whole.replace(whole.find("--checkpoint @ck"), 16, "");
        ASSERT_EQ(run(whole).exitCode, 0);
        std::filesystem::rename(path("out.exr"), path("whole.exr"));
        ASSERT_EQ(runRanks(4, command(method, 11)).exitCode, 0);
        ASSERT_EQ(run(command(method, 21)).exitCode, 0);
        ASSERT_EQ(runRanks(2, command(method, 30)).exitCode, 0);
        ASSERT_EQ(runRanks(3, command(method, 40)).exitCode, 0);
        expectSamePicture("out.exr", "whole.exr");
    }
}

TEST_F(RenderRanks, stopAtAnErrorWhereOneProcessDoes) {
    for (const char* method : {"bpt", "risbpt"}) {
        const std::string command = quick(method,
                                          "--quiet --threads 1 --json @o.json --until "
                                          "mape=0.1 --iterations 4000");
        ASSERT_EQ(run(command).exitCode, 0);
        const nlohmann::json one = json("o.json");
        EXPECT_EQ(one["stopped"], "error");
        std::filesystem::rename(path("out.exr"), path("whole.exr"));
        ASSERT_EQ(runRanks(3, command).exitCode, 0);
        const nlohmann::json many = json("o.json");
        EXPECT_EQ(many["stopped"], "error");
        EXPECT_EQ(many["iterations"], one["iterations"]);
        EXPECT_EQ(many["estimated_error"], one["estimated_error"]);
        expectSamePicture("out.exr", "whole.exr");
    }
}

/// Processes of this test's render, whose arguments name its directory.
std::vector<pid_t> processesOf(const std::string& directory) {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        const std::string name = entry.path().filename();
        if (!std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; })) continue;
        std::ifstream in(entry.path() / "cmdline", std::ios::binary);
        const std::string line{std::istreambuf_iterator<char>(in), {}};
        if (line.starts_with(LACUNA_RENDER) && line.find(directory) != std::string::npos) {
            found.push_back(std::stoi(name));
        }
    }
    std::ranges::sort(found);
    return found;
}

TEST_F(RenderRanks, surviveTheDeathOfTwoOfFour) {
    const std::string common =
        quick("bpt",
              "--quiet --threads 1 --width 48 --height 32 --block-iterations 16 "
              "--iterations 1000");
    ASSERT_EQ(run(common).exitCode, 0);
    std::filesystem::rename(path("out.exr"), path("whole.exr"));
    const std::string saving = common + " --checkpoint @ck --checkpoint-every 0.01s";
    std::thread killer([&] {
        // As soon as there is a checkpoint to continue from.
        for (int i = 0; i < 30000 && !exists("ck"); ++i) {
            std::this_thread::sleep_for(milliseconds(2));
        }
        const std::vector<pid_t> ranks = processesOf(path(""));
        EXPECT_EQ(ranks.size(), 4u);
        for (std::size_t i = 1; i < ranks.size() && i < 3; ++i) kill(ranks[i], SIGKILL);
    });
    const Outcome killed = runRanks(4, saving);
    killer.join();
    EXPECT_NE(killed.exitCode, 0);
    EXPECT_FALSE(exists("out.exr"));
    ASSERT_TRUE(exists("ck"));
    EXPECT_TRUE(processesOf(path("")).empty());
    const Outcome o = runRanks(3, saving);
    ASSERT_EQ(o.exitCode, 0) << o.err;
    expectSamePicture("out.exr", "whole.exr");
}

TEST_F(RenderRanks, stopAtATimeWithBlocksThatFollowEachOther) {
    for (const char* method : {"bpt", "risbpt"}) {
        const std::string common = quick(method,
                                         "--quiet --threads 1 --block-iterations 4 "
                                         "--json @o.json --iterations 100000000");
        const Outcome o = runRanks(3, common + " --time 1.5s");
        ASSERT_EQ(o.exitCode, 0) << o.err;
        const nlohmann::json j = json("o.json");
        EXPECT_EQ(j["stopped"], "time");
        EXPECT_GE(j["seconds"], 1.0);
        std::filesystem::rename(path("out.exr"), path("timed.exr"));
        std::string same = common;
        same.replace(same.find("100000000"), 9, std::to_string(j["iterations"].get<int>()));
        ASSERT_EQ(run(same).exitCode, 0);
        EXPECT_TRUE(readExrLayers(path("timed.exr")).channels() ==
                    readExrLayers(path("out.exr")).channels());
    }
}

TEST_F(RenderRanks, saveWhatThereIsAtAnInterruptOfAny) {
    for (const std::size_t which : {0u, 2u}) {
        std::filesystem::remove(path("ck"));
        std::filesystem::remove(path("out.exr"));
        const std::string command = quick("bpt",
                                          "--threads 1 --json @o.json --checkpoint @ck "
                                          "--checkpoint-every 0.01s --iterations 100000000");
        std::thread interrupter([&] {
            for (int i = 0; i < 30000 && !exists("ck"); ++i) {
                std::this_thread::sleep_for(milliseconds(2));
            }
            const std::vector<pid_t> ranks = processesOf(path(""));
            EXPECT_EQ(ranks.size(), 3u);
            if (which < ranks.size()) kill(ranks[which], SIGINT);
        });
        const Outcome o = runRanks(3, command);
        interrupter.join();
        EXPECT_EQ(o.exitCode, 130) << o.err;
        ASSERT_TRUE(exists("out.exr"));
        EXPECT_EQ(json("o.json")["stopped"], "interrupt");
    }
}

TEST_F(RenderRanks, sayOnceWhatIsWrong) {
    write("notes.txt", "no checkpoint");
    for (const auto& [arguments, code, part] :
         {std::tuple{"@room.gltf -o @out.exr --method nonsense" + std::string(), 2, "--method"},
          std::tuple{quick("bpt", "--verify"), 2, "--verify: expected one process"},
          std::tuple{"@none.gltf -o @out.exr --method bpt" + std::string(), 3, "none.gltf"},
          std::tuple{quick("bpt", "--checkpoint @notes.txt"), 3, "expected a checkpoint"}}) {
        expectFailure(arguments, code, part, mpirun(3).c_str());
    }
}

TEST_F(RenderRanks, printHelpOnce) {
    const std::string one = run("--list-methods").out;
    EXPECT_EQ(runRanks(3, "--list-methods").out, one);
    EXPECT_EQ(runRanks(2, "--version").out, run("--version").out);
    EXPECT_EQ(runRanks(2, "@room.gltf --effects").out, run("@room.gltf --effects").out);
}

/// A rank with another scene or another command would render parts of another picture.
TEST_F(RenderRanks, renderTheSame) {
    const std::string one = quick("bpt", "--quiet --threads 1"), other = one + " --seed 2";
    const Outcome o = runRanks(1, one + " : -n 1 " LACUNA_RENDER " " + other);
    EXPECT_EQ(o.exitCode, 3);
    EXPECT_NE(o.err.find("rank 1"), std::string::npos) << o.err;
    EXPECT_NE(o.err.find("seed (there '2', here '1')"), std::string::npos) << o.err;
    EXPECT_EQ(std::ranges::count(o.err, '\n'), 1) << o.err;
}

/// The other ranks read the caches that rank 0 has just made.
TEST_F(RenderRanks, readTheCachesThatRank0Makes) {
    const std::string command = quick("spcbpt", "--threads 1 -v");
    const Outcome o = runRanks(3, command);
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const auto built = [&](const std::string& text) {
        int count = 0;
        for (std::size_t at = 0; (at = text.find("built ", at)) != std::string::npos; ++at) ++count;
        return count;
    };
    std::filesystem::remove_all(path("cache"));
    const Outcome alone = run(command);
    EXPECT_EQ(built(o.err), built(alone.err));
    EXPECT_GT(built(o.err), 0);
}

}  // namespace
}  // namespace lacuna::test
