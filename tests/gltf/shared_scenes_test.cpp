// The real scenes beside the repository, if they are there: what they hold, and how long they take.
#include <chrono>
#include <map>

#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {
namespace {

namespace fs = std::filesystem;

/// $LACUNA_SHARED_SCENES, else ../shared/scenes beside the source directory.
fs::path sharedScenes() {
    if (const char* path = std::getenv("LACUNA_SHARED_SCENES")) return path;
    return fs::path(__FILE__).parent_path() / "../../../shared/scenes";
}

TEST(SharedScenes, AreWhatTheirReadmeSays) {
    const fs::path folder = sharedScenes();
    if (!fs::is_directory(folder)) {
        GTEST_SKIP() << "no scenes in " << folder << " (set LACUNA_SHARED_SCENES)";
    }
    // From the README beside them: all triangles arrive, none is flat.
    const std::map<std::string, std::size_t> triangles = {
        {"cornell-box", 36},   {"veach-mis", 12111},   {"veach-bidir", 11544},
        {"door", 20764},       {"door-pg2015", 21722}, {"sponza-crytek", 261839},
        {"classroom", 103830}, {"staircase", 262508}};
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() != ".glb") continue;
        const auto begin = std::chrono::steady_clock::now();
        const SceneDescription scene = loadGltf(entry.path().string());
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
        const std::string name = entry.path().stem().string();
        expectValid(scene);
        requireCamera(scene);
        std::size_t count = 0;
        for (const Instance& instance : scene.instances) {
            count += scene.meshes[instance.mesh].triangles.size();
        }
        std::printf(
            "%-14s %7zu triangles %3zu textures %8.1f ms (parse %.1f decode %.1f meshes %.1f)\n",
            name.c_str(), count, scene.textures.size(), 1e3 * seconds.count(),
            1e3 * scene.phaseSeconds.at("parse"), 1e3 * scene.phaseSeconds.at("decode"),
            1e3 * scene.phaseSeconds.at("meshes"));
        for (const std::string& warning : scene.warnings) std::printf("    %s\n", warning.c_str());
        if (triangles.contains(name)) {
            EXPECT_EQ(count, triangles.at(name)) << name;
        }
        EXPECT_TRUE(scene.width && scene.height && scene.maxDepth) << name;
        EXPECT_EQ(scene.environment.has_value(), name == "classroom") << name;
    }
}

TEST(LargeSceneSlow, MillionsOfTrianglesInSeconds) {
    constexpr std::uint32_t kSide = 2000;  // 8 million triangles
    GltfBuilder b;
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    positions.reserve(3ul * kSide * kSide);
    for (std::uint32_t y = 0; y < kSide; ++y) {
        for (std::uint32_t x = 0; x < kSide; ++x) {
            positions.insert(positions.end(), {float(x), float(y), float((x * y) % 7)});
            if (x == 0 || y == 0) continue;
            const std::uint32_t v = y * kSide + x;
            indices.insert(indices.end(), {v, v - 1, v - kSide, v - 1, v - kSide - 1, v - kSide});
        }
    }
    const json attributes = {{"POSITION", b.accessor(positions, "VEC3")}};
    b.mesh({{"attributes", attributes}, {"indices", b.accessor(indices, "SCALAR")}});
    b.rootNode({{"mesh", 0}});
    const TempDir dir;
    const std::string path = dir.write("large.glb", b.glb());
    const auto begin = std::chrono::steady_clock::now();
    const SceneDescription scene = loadGltf(path);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    std::printf("%zu triangles, %.2f s\n", scene.meshes[0].triangles.size(), seconds.count());
    EXPECT_EQ(scene.meshes[0].triangles.size(), indices.size() / 3);
    EXPECT_LT(seconds.count(), 10.0);
}

}  // namespace
}  // namespace lacuna::test
