// How much of the rays' own speed is left after shading, connecting and weighting.
//
//   render/SCENE/METHOD   one iteration; counters: million samples and rays per second, and
//                         `of_bare_embree`: that rate over the rate at which bare Embree traces the
//                         very rays of that iteration, replayed in their order by as many threads,
//                         measured right after it in the same run, because machines drift
//
// Scenes: the repository's Cornell box and door, and every .glb of $LACUNA_SHARED_SCENES.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "libcore/bidir/integrator.h"
#include "libcore/gltf/gltf.h"
#include "libcore/methods/registry.h"

namespace lacuna {
namespace {

constexpr int kSide = 256;
constexpr int kMaxDepth = 16;

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

void render(benchmark::State& state, const std::string& file, const MethodRow& row) {
    const ThreadPool pool;
    const Scene scene(loadGltf(file), pool);
    const Camera camera = scene.makeCamera("", {kSide, kSide}, {});
    const auto method = row.create(resolve(row, {}));
    RenderSettings settings;
    settings.limits.maxDepth = kMaxDepth;
    settings.crop = {0, kSide, 0, kSide};
    BidirIntegrator integrator(scene, camera, row.techniques, *method, settings, pool);
    const std::atomic<bool> never{false};
    IterationStatistics warmUp;
    integrator.warmUp(never, warmUp);
    std::vector<Rgb> pixels(std::size_t(kSide) * kSide);

    IterationStatistics recordedStatistics;
    integrator.setRecording(true);
    integrator.render(0, pixels, never, recordedStatistics);
    const std::vector<RecordedRay> rays = integrator.takeRecording();
    integrator.setRecording(false);

    double renderSeconds = 0.0, replaySeconds = 0.0;
    std::uint64_t traced = 0;
    std::uint32_t iteration = 1;
    for (auto _ : state) {
        IterationStatistics statistics;
        const auto start = Clock::now();
        integrator.render(iteration++, pixels, never, statistics);
        const double seconds = secondsSince(start);
        state.SetIterationTime(seconds);
        renderSeconds += seconds;
        traced += statistics.totalRays();

        const auto replayStart = Clock::now();
        constexpr std::size_t kBlock = 4096;
        pool.forEach((rays.size() + kBlock - 1) / kBlock, [&](std::size_t b) {
            const std::size_t n = std::min(kBlock, rays.size() - b * kBlock);
            benchmark::DoNotOptimize(scene.accel().replay(std::span(rays).subspan(b * kBlock, n)));
        });
        replaySeconds += secondsSince(replayStart);
    }
    const double iterations = double(state.iterations());
    const double rate = double(traced) / renderSeconds;
    const double bare = double(rays.size()) * iterations / replaySeconds;
    state.counters["Msamples/s"] = double(pixels.size()) * iterations / renderSeconds * 1e-6;
    state.counters["Mrays/s"] = rate * 1e-6;
    state.counters["bare_Mrays/s"] = bare * 1e-6;
    state.counters["of_bare_embree"] = rate / bare;
}

/// Peak and stored size of a pool of 10^6 light subpaths.
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
        integrator.warmUp(never, statistics);
    }
    const LightPool& light = integrator.pool();
    const double vertices = double(light.vertices().size());
    const double bytes = vertices * sizeof(PathVertex) +
                         double(light.connectable().size()) * sizeof(LightPool::Entry);
    state.counters["vertices"] = vertices;
    state.counters["bytes/vertex"] = bytes / vertices;
    state.counters["MB"] = bytes * 1e-6;
}

void registerScene(const std::filesystem::path& file) {
    const std::string name = file.stem().string();
    for (const MethodRow& row : methods()) {
        benchmark::RegisterBenchmark(("render/" + name + "/" + row.name).c_str(), render,
                                     file.string(), row)
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
    }
    benchmark::RegisterBenchmark(("pool/" + name).c_str(), lightPool, file.string())
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
    const std::filesystem::path own = LACUNA_SCENES;
    for (const char* name : {"cornell-box.glb", "door.glb"}) lacuna::registerScene(own / name);
    if (const char* shared = std::getenv("LACUNA_SHARED_SCENES")) {
        for (const auto& entry : std::filesystem::directory_iterator(shared)) {
            if (entry.path().extension() == ".glb") lacuna::registerScene(entry.path());
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
