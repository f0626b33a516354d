// Machines that give less than a render asks for: memory, threads, room in files.
#include <sys/sysinfo.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

class RenderResources : public RenderTool {
  protected:
    /// The tool under a limit of the system: "--as=BYTES", "--fsize=BYTES".
    static std::string limited(const std::string& limit, const std::string& tool = LACUNA_RENDER) {
        return "prlimit " + limit + " " + tool;
    }
    void expectOneLine(const std::string& arguments, const std::string& tool,
                       const std::string& part) const {
        const Outcome o = run(arguments, tool.c_str());
        EXPECT_EQ(o.exitCode, 1) << o.err;
        EXPECT_NE(o.err.find(part), std::string::npos) << o.err;
        EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
        EXPECT_TRUE(temporaries().empty());
    }
};

TEST_F(RenderResources, threadsThatCannotBeStartedAreAnError) {
    if (LACUNA_SANITIZED) GTEST_SKIP() << "a sanitizer maps more than any limit";
    const std::string tool = limited("--as=400000000");
    expectOneLine(quick("pt", "--quiet --threads 64"), tool, "--threads: expected to start 64");
    EXPECT_FALSE(exists("out.exr"));
    EXPECT_EQ(run(quick("pt", "--quiet --threads 2"), tool.c_str()).exitCode, 0);
}

TEST_F(RenderResources, threadsBeyondUseAreNotStarted) {
    ASSERT_EQ(run(quick("pt", "--quiet --threads 4096 --json @o.json")).exitCode, 0);
    EXPECT_LE(json("o.json")["threads"].get<int>(), std::max(64, 4 * get_nprocs()));
}

/// Memory may end in any step and in any thread.
TEST_F(RenderResources, memoryThatEndsIsOneLine) {
    if (LACUNA_SANITIZED) GTEST_SKIP() << "a sanitizer maps more than any limit";
    for (const int megabytes : {168, 175, 182, 190, 210, 230, 250, 270, 290}) {
        const std::string limit = "--as=" + std::to_string(megabytes) + "000000";
        for (const char* tool : {LACUNA_RENDER, LACUNA_TRAIN, LACUNA_VOXELIZE}) {
            const bool renders = tool == std::string(LACUNA_RENDER);
            const Outcome o =
                run(renders ? quick("bpt", "--quiet --width 600 --height 400 --iterations 1")
                            : "@room.gltf --quiet --cache @" + std::to_string(megabytes),
                    limited(limit, tool).c_str());
            EXPECT_TRUE(o.exitCode == 0 || o.exitCode == 1) << limit << " " << tool << o.err;
            EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), o.exitCode) << o.err;
            EXPECT_EQ(o.err.find("unknown error"), std::string::npos) << o.err;
        }
    }
}

/// By default, ulimit -f ends a process by a signal.
TEST_F(RenderResources, filesThatMayNotGrowAreAnErrorOfWriting) {
    const std::string tool = limited("--fsize=2000");
    expectOneLine(quick("pt", "--quiet"), tool, "out.exr: expected to write");
    EXPECT_FALSE(exists("out.exr"));
    // The picture is small enough for the limit; the JSON is not.
    expectOneLine(
        "@room.gltf -o @out.png --method pt --width 2 --height 2 --iterations 1 --quiet "
        "--json @o.json",
        tool, "o.json: expected to write");
    EXPECT_TRUE(exists("out.png"));
    EXPECT_FALSE(exists("o.json"));
}

/// Embree accepts no ray from beyond 1.8e18, so geometry there would be missing from the picture.
TEST_F(RenderResources, scenesThatAreTooLargeForFloatsAreRefused) {
    TinyScene scene;
    const auto withRoot = [&](const char* key, const nlohmann::json& value) {
        nlohmann::json j = nlohmann::json::parse(scene.text());
        j["nodes"].push_back({{"children", j["scenes"][0]["nodes"]}, {key, value}});
        j["scenes"][0]["nodes"] = {j["nodes"].size() - 1};
        write("large.gltf", j.dump());
    };
    const auto withNode = [&](std::size_t node, const char* key, const nlohmann::json& value) {
        nlohmann::json j = nlohmann::json::parse(scene.text());
        j["nodes"][node][key] = value;
        write("large.gltf", j.dump());
    };
    const std::string arguments =
        "@large.gltf -o @out.exr --method bpt --width 24 --height 16 --iterations 2 --quiet";
    for (const double size : {3e17, 3e18, 3e19, 1e30, 3e37}) {
        withRoot("scale", {size, size, size});
        expectFailure(arguments, 3, "within 1e+17");
        for (std::size_t node = 0; node < nlohmann::json::parse(scene.text())["nodes"].size();
             ++node) {
            withNode(node, "translation", {size, 0, 0});
            expectFailure(arguments, 3, "within 1e+17");
        }
    }
    withRoot("scale", {1e16, 1e16, 1e16});
    EXPECT_EQ(run(arguments).exitCode, 0);
    withRoot("translation", {1e19, 0, 0});  // moves everything: nothing is far from the middle
    EXPECT_EQ(run(arguments).exitCode, 0);
    expectFailure("@room.gltf -o @out.exr --method pt --aperture 1e20 --focus 1", 2, "--aperture");
    expectFailure("@room.gltf -o @out.exr --method pt --aperture 1 --focus 1e20", 2, "--focus");
}

}  // namespace
}  // namespace lacuna::test
