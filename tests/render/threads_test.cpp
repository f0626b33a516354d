// The same command gives the same pixels, bit for bit, with any number of threads.
#include <sched.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "libcore/image/exr.h"
#include "libcore/methods/registry.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

/// Renders with 1, 2 and 7 threads and compares every channel.
class RenderThreads : public RenderTool, public ::testing::WithParamInterface<std::string> {
  protected:
    void expectTheSame(const std::string& arguments) const {
        std::map<std::string, std::vector<float>> first;
        for (const char* threads : {"1", "2", "7"}) {
            const Outcome o = run(arguments + " --quiet --threads " + threads);
            ASSERT_EQ(o.exitCode, 0) << o.err;
            const LayeredImage image = readExrLayers(path("out.exr"));
            if (first.empty()) {
                first = image.channels();
                continue;
            }
            ASSERT_EQ(image.channels().size(), first.size());
            for (const auto& [name, values] : image.channels()) {
                EXPECT_EQ(values, first.at(name)) << name << ", " << threads << " threads";
            }
        }
    }
};

/// The options with which a method builds its caches on our scenes.
std::string preparing(const std::string& method) {
    const MethodRow& row = findMethod(method);
    const std::vector<AssetNeed> needs = needsOf(row, resolve(row, {}));
    std::string text = needs.empty() ? "" : " --prepare --cache @cache";
    for (const AssetNeed& need : needs) {
        if (need.name == "subspaces") {
            text +=
                " --set train.paths=5000 --set train.subspaces=50 --set "
                "train.light_paths=5000 --set candidates=5000";
        }
    }
    return text;
}

class RenderWithSkeleton : public RenderTool {};

/// Files round positions. A render that makes a file must use the rounded ones, as the next render
/// will.
TEST_F(RenderWithSkeleton, MakesThePictureThatItsFileMakes) {
    const std::string command = std::string(LACUNA_SCENES) +
                                "/court.glb -o @out.exr --method skelbpt --iterations 16 --prepare "
                                "--cache @cache --set candidates=100 --set voxels.resolution=16 "
                                "--width 24 --height 16 --quiet";
    ASSERT_EQ(run(command).exitCode, 0);
    const LayeredImage made = readExrLayers(path("out.exr"));
    ASSERT_EQ(run(command).exitCode, 0);
    EXPECT_EQ(readExrLayers(path("out.exr")).channels(), made.channels());
}

class RenderThreadsSlow : public RenderThreads {};

std::vector<std::string> names() {
    std::vector<std::string> all;
    for (const MethodRow& row : methods()) all.push_back(row.name);
    return all;
}

std::string nameOf(const ::testing::TestParamInfo<std::string>& method) {
    std::string name = method.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

TEST_P(RenderThreads, PixelsAreTheSame) {
    expectTheSame(quick(GetParam(), "--width 50 --height 37 --iterations 3 --techniques"));
}
INSTANTIATE_TEST_SUITE_P(Methods, RenderThreads, ::testing::ValuesIn(names()), nameOf);

constexpr std::array<const char*, 3> kScenes = {"cornell-box", "kitchen-glass",
                                                "light-environment"};

std::string onScene(const char* scene, const std::string& method) {
    return std::string(LACUNA_SCENES) + "/" + scene +
           ".glb -o @out.exr --width 64 --height 36 --iterations 4 --method " + method +
           preparing(method);
}

/// By day, each method runs in one of the scenes.
TEST_P(RenderThreadsSlow, PixelsAreTheSameOnOneOfOurScenes) {
    const std::vector<std::string> all = names();
    const auto place = std::size_t(std::ranges::find(all, GetParam()) - all.begin());
    expectTheSame(onScene(kScenes[place % kScenes.size()], GetParam()));
}
TEST_P(RenderThreadsSlow, NightPixelsAreTheSameOnOurScenes) {
    for (const char* scene : kScenes) expectTheSame(onScene(scene, GetParam()));
}
INSTANTIATE_TEST_SUITE_P(Methods, RenderThreadsSlow, ::testing::ValuesIn(names()), nameOf);

using RenderSeed = RenderTool;

TEST_F(RenderSeed, AnotherSeedIsAnotherPicture) {
    ASSERT_EQ(run(quick("pt", "--quiet --seed 1")).exitCode, 0);
    const auto one = *readExrLayers(path("out.exr")).find("R");
    ASSERT_EQ(run(quick("pt", "--quiet")).exitCode, 0);  // 1 is the default
    EXPECT_EQ(*readExrLayers(path("out.exr")).find("R"), one);
    for (const char* seed : {"2", "4294967297", "18446744073709551615"}) {
        ASSERT_EQ(run(quick("pt", std::string("--quiet --seed ") + seed)).exitCode, 0) << seed;
        EXPECT_NE(*readExrLayers(path("out.exr")).find("R"), one) << seed;
    }
}

using RenderProcessors = RenderTool;

/// mpirun and containers may give a process only some of the machine's processors.
TEST_F(RenderProcessors, threadsAreThoseThatTheProcessMayHave) {
    cpu_set_t allowed;
    ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
    int first = 0;
    while (!CPU_ISSET(first, &allowed)) ++first;
    const std::string tool = "taskset -c " + std::to_string(first) + " " + ownTool();
    ASSERT_EQ(run(quick("pt", "--quiet --json @o.json"), tool.c_str()).exitCode, 0);
    EXPECT_EQ(json("o.json")["threads"], 1);
    ASSERT_EQ(run(quick("pt", "--quiet --json @o.json")).exitCode, 0);
    EXPECT_EQ(json("o.json")["threads"], CPU_COUNT(&allowed));
}

}  // namespace
}  // namespace lacuna::test
