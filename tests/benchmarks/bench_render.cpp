// How much of the rays' own speed is left after shading, connecting and weighting.
//
//   render/SCENE/METHOD   one iteration; counters: million samples and rays per second, and
//                         `of_bare_embree`: that rate over the rate at which bare Embree traces the
//                         very rays of that iteration, replayed in their order by as many threads,
//                         measured right after it in the same run, because machines drift
//   effects/SCENE/METHOD  `all_over_needed`: time of an iteration with every effect forced on that
//                         leaves the picture as it is (--effect NAME=on), over the time with
//                         those alone that the scene calls for; both in turn
//   tolerance/SCENE/METHOD  `all_over_within`: time of an iteration with a clearcoat of weight 1e-4
//                         on every material, over the time with it left out by --tolerance 0.001
//   pool/SCENE            memory of a pool of light subpaths
//
// Scenes: the repository's, and every .glb of $LACUNA_SHARED_SCENES.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "libcore/bidir/integrator.h"
#include "libcore/gltf/gltf.h"
#include "libcore/methods/registry.h"
#include "libcore/tool/effect_switches.h"
#include "libcore/tool/tolerance.h"

namespace lacuna {
namespace {

constexpr int kSide = 256;
constexpr int kMaxDepth = 16;

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A scene, warmed up, whose iterations can be timed.
class Bench {
  public:
    Bench(SceneDescription description, const MethodRow& row)
        : scene_(std::move(description), pool_),
          camera_(scene_.makeCamera("", {kSide, kSide}, {})),
          method_(row.create(resolve(row, {}))),
          integrator_(scene_, camera_, row.techniques, *method_, settings(), pool_) {
        IterationStatistics warmUp;
        integrator_.beginBlock(0, *method_, never_, warmUp);
    }

    const ThreadPool& pool() const { return pool_; }
    const Scene& scene() const { return scene_; }
    std::size_t pixelCount() const { return pixels_.size(); }

    /// Renders one iteration and returns its seconds; adds its rays to `traced`.
    double iterate(std::uint64_t& traced) {
        IterationStatistics statistics;
        const auto start = Clock::now();
        integrator_.render(iteration_++, pixels_, never_, statistics);
        const double seconds = secondsSince(start);
        traced += statistics.totalRays();
        return seconds;
    }
    std::vector<RecordedRay> record() {
        std::uint64_t traced = 0;
        integrator_.delivery().setRecording(true);
        iterate(traced);
        std::vector<RecordedRay> rays = integrator_.delivery().takeRecording();
        integrator_.delivery().setRecording(false);
        return rays;
    }

  private:
    static RenderSettings settings() {
        RenderSettings settings;
        settings.limits.maxDepth = kMaxDepth;
        settings.crop = {0, kSide, 0, kSide};
        return settings;
    }

    const std::atomic<bool> never_{false};
    ThreadPool pool_;
    Scene scene_;
    Camera camera_;
    std::unique_ptr<Method> method_;
    BidirIntegrator integrator_;
    std::vector<Rgb> pixels_ = std::vector<Rgb>(std::size_t(kSide) * kSide);
    std::uint32_t iteration_ = 0;
};

void render(benchmark::State& state, const std::string& file, const MethodRow& row) {
    Bench bench(loadGltf(file), row);
    const std::vector<RecordedRay> rays = bench.record();

    double renderSeconds = 0.0, replaySeconds = 0.0;
    std::uint64_t traced = 0;
    for (auto _ : state) {
        const double seconds = bench.iterate(traced);
        state.SetIterationTime(seconds);
        renderSeconds += seconds;

        const auto replayStart = Clock::now();
        constexpr std::size_t kBlock = 4096;
        bench.pool().forEach((rays.size() + kBlock - 1) / kBlock, [&](std::size_t b) {
            const std::size_t n = std::min(kBlock, rays.size() - b * kBlock);
            benchmark::DoNotOptimize(
                bench.scene().accel().replay(std::span(rays).subspan(b * kBlock, n)));
        });
        replaySeconds += secondsSince(replayStart);
    }
    const double iterations = double(state.iterations());
    const double rate = double(traced) / renderSeconds;
    const double bare = double(rays.size()) * iterations / replaySeconds;
    state.counters["Msamples/s"] = double(bench.pixelCount()) * iterations / renderSeconds * 1e-6;
    state.counters["Mrays/s"] = rate * 1e-6;
    state.counters["bare_Mrays/s"] = bare * 1e-6;
    state.counters["of_bare_embree"] = rate / bare;
}

SceneDescription withEverythingOn(SceneDescription description) {
    double pinhole = 0.0;
    std::vector<Effect> effects = effectsOf(description, pinhole, nullptr);
    const std::vector<EffectSwitch> switches = {
        {"textures", true},   {"emissive_textures", true}, {"normal_maps", true},
        {"alpha_mask", true}, {"vertex_colors", true},     {"attenuation", true}};
    forceEffects(switches, {description, pinhole, nullptr}, effects);
    return description;
}

/// Times both in turn; the counter is the second one's time over the first one's.
void compare(benchmark::State& state, const char* counter, Bench& first, Bench& second) {
    double firstSeconds = 0.0, secondSeconds = 0.0;
    std::uint64_t traced = 0;
    for (auto _ : state) {
        const double seconds = first.iterate(traced);
        state.SetIterationTime(seconds);
        firstSeconds += seconds;
        secondSeconds += second.iterate(traced);
    }
    state.counters[counter] = secondSeconds / firstSeconds;
}

void effects(benchmark::State& state, const std::string& file, const MethodRow& row) {
    Bench needed(loadGltf(file), row), all(withEverythingOn(loadGltf(file)), row);
    compare(state, "all_over_needed", needed, all);
}

void tolerance(benchmark::State& state, const std::string& file, const MethodRow& row) {
    SceneDescription coated = loadGltf(file);
    for (Material& m : coated.materials) m.clearcoat = 1e-4f;
    SceneDescription bare = coated;
    leaveOutWithin(1e-3, bare);
    Bench within(std::move(bare), row), all(std::move(coated), row);
    compare(state, "all_over_within", within, all);
}

/// The size of a pool of 10^6 light subpaths.
void lightPool(benchmark::State& state, const std::string& file) {
    const ThreadPool pool;
    const Scene scene(loadGltf(file), pool);
    const Camera camera = scene.makeCamera("", {kSide, kSide}, {});
    const MethodRow& row = findMethod("lvcbpt");
    const std::vector<std::string> million = {"candidates=1000000"};
    const auto method = row.create(resolve(row, million));
    RenderSettings settings;
    settings.crop = {0, kSide, 0, kSide};
    BidirIntegrator integrator(scene, camera, row.techniques, *method, settings, pool);
    const std::atomic<bool> never{false};
    for (auto _ : state) {
        IterationStatistics statistics;
        const auto fresh = row.create(resolve(row, million));
        integrator.beginBlock(0, *fresh, never, statistics);
    }
    const LightPool& light = integrator.pool();
    const double vertices = double(light.vertices().size());
    const double bytes = vertices * sizeof(PathVertex) +
                         double(light.connectable().size()) * sizeof(LightPool::Entry);
    state.counters["vertices"] = vertices;
    state.counters["bytes/vertex"] = bytes / vertices;
    state.counters["MB"] = bytes * 1e-6;
}

void registerScene(const std::filesystem::path& file, const std::string& prefix) {
    const std::string name = prefix + file.stem().string();
    for (const MethodRow& row : methods()) {
        benchmark::RegisterBenchmark(("render/" + name + "/" + row.name).c_str(), render,
                                     file.string(), row)
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
    }
    for (const char* method : {"pt", "bpt"}) {
        benchmark::RegisterBenchmark(("effects/" + name + "/" + method).c_str(), effects,
                                     file.string(), findMethod(method))
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
        benchmark::RegisterBenchmark(("tolerance/" + name + "/" + method).c_str(), tolerance,
                                     file.string(), findMethod(method))
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
    }
    benchmark::RegisterBenchmark(("pool/" + name).c_str(), lightPool, file.string())
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
}

void registerScenes(const std::filesystem::path& folder, const std::string& prefix) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".glb") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path& file : files) registerScene(file, prefix);
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
    lacuna::registerScenes(LACUNA_SCENES, "");
    if (const char* shared = std::getenv("LACUNA_SHARED_SCENES")) {
        lacuna::registerScenes(shared, "shared-");
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
