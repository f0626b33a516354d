#include "libcore/bidir/integrator.h"

#include <algorithm>

namespace lacuna {

BidirIntegrator::BidirIntegrator(const Scene& scene, const Camera& camera, Techniques techniques,
                                 Method& method, const RenderSettings& settings,
                                 const ThreadPool& threads)
    : setup_(scene, camera, techniques, settings, threads),
      method_(method),
      workers_(threads, settings.limits.maxDepth) {}

TechniqueCounts BidirIntegrator::freeze(std::uint32_t iteration) {
    TechniqueCounts counts;
    counts.hit = setup_.techniques.hits;
    counts.splats = setup_.techniques.splats ? double(setup_.lightPaths) : 0.0;
    const ConnectionDensity& density = method_.freeze(iteration);
    if (setup_.techniques.connects) counts.connectThrough(density);
    counts.rouletteDepth = setup_.settings.limits.rouletteDepth;
    return counts;
}

IterationContext BidirIntegrator::contextFor(IterationStatistics& statistics) const {
    return {setup_.space, setup_.threads, setup_.settings.seed, setup_.filmPixels(), statistics};
}

LightPass::Purpose BidirIntegrator::poolAlone(StreamKind stream) const {
    return {stream, method_.pool().subpaths, 0};
}

bool BidirIntegrator::warmUp(const std::atomic<bool>& cancel, IterationStatistics& statistics) {
    PhaseTimer timer(statistics, "warm-up");
    for (int i = 0; i < method_.warmupIterations(); ++i) {
        const auto number = std::uint32_t(i);
        const Iteration iteration{number, freeze(number), {}, statistics, cancel};
        if (!lightPass_.run(iteration, poolAlone(StreamKind::Warmup), pool_)) return false;
        IterationContext context = contextFor(statistics);
        method_.prepare(pool_, context);
        method_.observe(pool_, context);
    }
    return true;
}

bool BidirIntegrator::render(std::uint32_t number, std::span<Rgb> pixels,
                             const std::atomic<bool>& cancel, IterationStatistics& statistics) {
    std::fill(pixels.begin(), pixels.end(), Rgb{});
    const Techniques& techniques = setup_.techniques;
    const Iteration iteration{number, freeze(number), pixels, statistics, cancel};
    IterationContext context = contextFor(statistics);
    {
        PhaseTimer timer(statistics, "light paths");
        LightPass::Purpose purpose = poolAlone(StreamKind::LightPath);
        if (techniques.splats) purpose.splats = setup_.lightPaths;
        if (!lightPass_.run(iteration, purpose, pool_)) return false;
    }
    if (pool_.subpaths() > 0) {
        statistics.hold("light vertices", pool_.vertices().size());
        statistics.hold("light vertex bytes", pool_.vertices().size_bytes());
    }
    {
        PhaseTimer timer(statistics, "prepare");
        method_.prepare(pool_, context);
    }
    if (techniques.hits || techniques.connects) {
        PhaseTimer timer(statistics, "eye paths");
        if (!eyePass_.run(iteration)) return false;
    }
    {
        PhaseTimer timer(statistics, "observe");
        method_.observe(pool_, context);
    }
    delivery_.countIteration();
    return true;
}

BidirIntegrator::Replayed BidirIntegrator::replayEyePath(std::uint32_t number, int x, int y,
                                                         const PathObserver& observer) {
    const std::atomic<bool> never{false};
    IterationStatistics ignored;
    const Iteration iteration{number, freeze(number), {}, ignored, never};
    if (method_.pool().subpaths > 0) {
        lightPass_.run(iteration, poolAlone(StreamKind::LightPath), pool_);
    }
    IterationContext context = contextFor(ignored);
    method_.prepare(pool_, context);
    TaskResult result;
    Rgb pixel;
    Worker& worker = workers_.own();
    const PathObserver before = delivery_.setObserver(observer);
    eyePass_.pixelRow(iteration, x, y, {&pixel, 1}, worker, result);
    delivery_.setObserver(before);
    return {worker.eye[0], worker.light[0]};
}

BidirIntegrator::Replayed BidirIntegrator::replayLightPath(std::uint32_t number, std::uint64_t path,
                                                           const PathObserver& observer) {
    const std::atomic<bool> never{false};
    IterationStatistics ignored;
    const Iteration iteration{number, freeze(number), {}, ignored, never};
    TaskResult result;
    Worker& worker = workers_.own();
    const PathObserver before = delivery_.setObserver(observer);
    lightPass_.trace({&path, 1}, iteration, {StreamKind::LightPath, 0, setup_.lightPaths}, worker,
                     result);
    delivery_.setObserver(before);
    return {{}, worker.light[0]};
}

}  // namespace lacuna
