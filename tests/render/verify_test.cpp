// --verify and --replay: the second way to every weight, and one sample rendered alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libcore/base/parallel.h"
#include "libcore/bidir/verify.h"
#include "libcore/gltf/gltf.h"
#include "libcore/image/exr.h"
#include "libcore/methods/registry.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

class RenderVerify : public RenderTool {};
class RenderVerifySlow : public RenderTool {
  protected:
    static constexpr std::size_t kParts = 4;
    /// `part` of every fourth method per scene, so that each method is on every fourth scene.
    void expectFullProductsOnOurScenes(std::size_t part) const;
};

void RenderVerifySlow::expectFullProductsOnOurScenes(std::size_t part) const {
    std::vector<std::string> scenes;
    for (const auto& entry : std::filesystem::directory_iterator(LACUNA_SCENES)) {
        if (entry.path().extension() == ".glb") scenes.push_back(entry.path().string());
    }
    std::ranges::sort(scenes);
    // Depths of roulette alternate over scenes and methods: over twelve scenes, a method has had
    // all.
    const std::array<const char*, 3> depths = {"1", "3", "100"};
    for (std::size_t s = 0; s < scenes.size(); ++s) {
        for (std::size_t m = (s + part) % kParts; m < methods().size(); m += kParts) {
            const std::string& name = methods()[m].name;
            const Outcome o =
                run(scenes[s] +
                    " -o @out.exr --width 32 --height 22 --iterations 1 --verify --json "
                    "@o.json --quiet --rr-depth " +
                    depths[(s / 2 + m) % depths.size()] + " --method " + name + cheap(name));
            ASSERT_EQ(o.exitCode, 0) << o.err;
            const nlohmann::json report = json("o.json");
            EXPECT_LT(report["verify"]["max_difference"].get<double>(), 1e-4)
                << scenes[s] << " " << name << " " << report["verify"];
            EXPECT_EQ(report["invalid_samples"], 0) << scenes[s] << " " << name;
        }
    }
}

TEST_F(RenderVerify, WeightsEqualTheirFullProducts) {
    TinyScene scene;
    scene.pointLight = true;
    write("both.gltf", scene.text());
    for (const MethodRow& row : methods()) {
        const Outcome o =
            run("@both.gltf -o @out.exr --width 24 --height 16 --iterations 2 --verify --json "
                "@o.json --method " +
                row.name + cheap(row.name));
        ASSERT_EQ(o.exitCode, 0) << o.err;
        EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), row.biased ? 1 : 0) << o.err;
        const nlohmann::json v = json("o.json").at("verify");
        EXPECT_LT(v.at("max_difference").get<double>(), 1e-5) << row.name;
        EXPECT_GT(v.at("paths").get<int>(), 200) << row.name;
        EXPECT_EQ(v.at("not_a_number"), 0);
        EXPECT_NE(o.out.find("verify"), std::string::npos);
    }
}

TEST_F(RenderVerify, OfAShiftedCameraWithALens) {
    const Outcome o =
        run(quick("bpt",
                  "--quiet --verify --shift 0.2,-0.35 --aperture 0.05 --focus 3 --crop "
                  "2,20,1,13 --json @o.json"));
    ASSERT_EQ(o.exitCode, 0) << o.err;
    EXPECT_LT(json("o.json").at("verify").at("max_difference").get<double>(), 1e-5);
}

TEST_F(RenderVerifySlow, OnOurScenes) {
    expectFullProductsOnOurScenes(0);
}
TEST_F(RenderVerifySlow, NightOnOurScenes) {
    for (std::size_t part = 1; part < kParts; ++part) expectFullProductsOnOurScenes(part);
}

TEST_F(RenderVerify, ReadsNoStoredDensity) {
    // Every density that a walk stored is spoiled: misWeight must notice, and the products must
    // not.
    const ThreadPool pool(2);
    const Scene scene(loadGltf(path("room.gltf")), pool);
    const Camera camera = scene.makeCamera("", {16, 12}, {});
    const MethodRow& row = findMethod("bpt");
    const auto method = row.create(resolve(row, {}));
    RenderSettings settings;
    settings.limits.rouletteDepth = 1;
    settings.crop = {0, 16, 0, 12};
    BidirIntegrator integrator(scene, camera, row.techniques, *method, settings, pool);
    const Walker walker(scene, camera, settings.limits);

    std::mutex mutex;
    int paths = 0, noticed = 0;
    double worst = 0.0;
    integrator.delivery().setObserver([&](const PathEvent& e) {
        const std::lock_guard lock(mutex);
        FullPath spoilt = e.path;
        std::vector<PathVertex> vertices;
        vertices.reserve(std::size_t(e.path.edges) + 1);
        for (int i = 0; i <= e.path.edges; ++i) {
            const auto n = std::size_t(i);
            PathVertex v = *e.path.vertex[n];
            v.pdfA = v.pdfReverseA = v.toPreviousFactor = v.survival = std::nanf("");
            v.throughput = v.scatter = Rgb(std::nanf(""));
            vertices.push_back(v);
            spoilt.vertex[n] = &vertices.back();
            spoilt.lightPdfA[n] *= 1.5f;
            spoilt.survival[n] *= 0.5f;
            spoilt.scatter[n] *= 2.0f;
        }
        const double again = misWeightByProducts(walker, spoilt, e.counts, e.technique);
        worst = std::max(worst, std::fabs(again - e.weight));
        noticed += std::fabs(misWeight(spoilt, e.counts, e.technique) - e.weight) > 1e-4;
        ++paths;
    });
    const std::atomic<bool> never{false};
    IterationStatistics statistics;
    std::vector<Rgb> pixels(16 * 12);
    integrator.beginBlock(0, *method, never, statistics);
    integrator.render(0, pixels, never, statistics);
    EXPECT_GT(paths, 500);
    EXPECT_LT(worst, 1e-5);
    EXPECT_GT(noticed, paths / 2);
}

TEST_F(RenderVerify, AWrongWeightIsReportedWithItsReplay) {
    const ThreadPool pool(1);
    const Scene scene(loadGltf(path("room.gltf")), pool);
    const Camera camera = scene.makeCamera("", {16, 12}, {});
    const MethodRow& row = findMethod("pt");
    const auto method = row.create(resolve(row, {}));
    RenderSettings settings;
    settings.crop = {0, 16, 0, 12};
    BidirIntegrator integrator(scene, camera, row.techniques, *method, settings, pool);
    WeightVerifier verifier(integrator.walker(), pool);
    EXPECT_EQ(verifier.result().paths, 0u);
    integrator.delivery().setObserver([&](const PathEvent& e) {
        PathEvent wrong = e;
        if (e.sample.number == 5 * 16 + 9) wrong.weight += 0.25;
        if (e.sample.number == 6 * 16 + 2) wrong.weight = std::nan("");
        verifier.check(wrong);
    });
    const std::atomic<bool> never{false};
    IterationStatistics statistics;
    std::vector<Rgb> pixels(16 * 12);
    integrator.render(0, pixels, never, statistics);
    const WeightVerifier::Result result = verifier.result();
    EXPECT_GT(result.notNumbers, 0u);
    EXPECT_EQ(result.maxDifference, 1.0);
    EXPECT_EQ(result.replay, "2,6,0");
}

class RenderReplay : public RenderTool {
  protected:
    /// The numbers after `key` in every line that begins with `start`.
    static std::vector<double> after(const std::string& text, const std::string& start,
                                     const std::string& key, int count) {
        std::vector<double> values;
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            if (line.rfind(start, 0) != 0) continue;
            const std::size_t at = line.find(key);
            if (at == std::string::npos) continue;
            std::istringstream rest(line.substr(at + key.size()));
            double value = 0.0;
            for (int i = 0; i < count && rest >> value; ++i) values.push_back(value);
        }
        return values;
    }
};

TEST_F(RenderReplay, GivesTheSampleThatWasRendered) {
    // One iteration of path tracing: a pixel is the sum of its replayed contributions.
    ASSERT_EQ(run(quick("pt", "--quiet --iterations 1")).exitCode, 0);
    const LayeredImage image = readExrLayers(path("out.exr"));
    int bright = 0;
    for (const int x : {3, 12, 17}) {
        for (const int y : {2, 9, 14}) {
            const Outcome o =
                run("@room.gltf --method pt --width 24 --height 16 --max-depth 6 --replay " +
                    std::to_string(x) + "," + std::to_string(y) + ",0");
            ASSERT_EQ(o.exitCode, 0) << o.err;
            const auto total = after(o.out, "total:", "contributions,", 3);
            ASSERT_EQ(total.size(), 3u) << o.out;
            const auto pixel = std::size_t(y * 24 + x);
            EXPECT_NEAR(total[0], image.find("R")->at(pixel), 1e-5 * (1.0 + total[0])) << o.out;
            EXPECT_NEAR(total[2], image.find("B")->at(pixel), 1e-5 * (1.0 + total[2]));
            bright += total[0] > 0.0;
            for (const double sum : after(o.out, "contribution", "sum over strategies ", 1)) {
                EXPECT_NEAR(sum, 1.0, 1e-5) << o.out;
            }
            const auto weights = after(o.out, "contribution", "weight ", 1);
            const auto products = after(o.out, "contribution", "by products ", 1);
            ASSERT_EQ(weights.size(), products.size());
            for (std::size_t i = 0; i < weights.size(); ++i) {
                EXPECT_NEAR(weights[i], products[i], 1e-5);
            }
            // z0 is the lens, in the file's coordinates.
            EXPECT_NE(o.out.find("z0 lens at 0 0 3"), std::string::npos) << o.out;
        }
    }
    EXPECT_GT(bright, 4);
}

TEST_F(RenderReplay, WorksForEveryMethodAndForLightPaths) {
    for (const MethodRow& row : methods()) {
        const std::string start =
            "@room.gltf --width 24 --height 16 --method " + row.name + cheap(row.name);
        const Outcome eye = run(start + " --replay 12,14,3");
        EXPECT_EQ(eye.exitCode, 0) << eye.err;
        EXPECT_NE(eye.out.find("z1 surface"), std::string::npos) << eye.out;
        const Outcome light = run(start + " --replay light:5,3 --crop 0,2,0,2");
        EXPECT_EQ(light.exitCode, 0) << light.err;
        EXPECT_NE(light.out.find("y0 light"), std::string::npos) << light.out;
        EXPECT_EQ(run(start + " --replay light:5,3").out, light.out);
    }
    EXPECT_FALSE(exists("out.exr"));
}

}  // namespace
}  // namespace lacuna::test
