// (theory.md, "What is exact, and why", "Blocks")
#include "libcore/bidir/integrator.h"

#include <algorithm>

#include "libcore/bidir/footprint.h"

namespace lacuna {

namespace {

std::shared_ptr<const ChainSeeds> waysOf(const RenderSetup& setup) {
    const bool traced = setup.settings.chainSeeds || !setup.techniques.askForWays();
    return traced ? setup.settings.chainSeeds
                  : std::make_shared<const ChainSeeds>(setup.scene, setup.threads);
}

std::unique_ptr<const SpecularChains> chainsOf(const RenderSetup& setup,
                                               const std::shared_ptr<const ChainSeeds>& ways) {
    if (!setup.techniques.searchForChains()) return nullptr;
    auto chains = std::make_unique<const SpecularChains>(setup.walker, ways,
                                                         setup.settings.glassEffort.chains);
    return chains->empty() ? nullptr : std::move(chains);
}

std::unique_ptr<const KnownWays> knownWaysOf(const RenderSetup& setup,
                                             const std::shared_ptr<const ChainSeeds>& ways) {
    if (!setup.techniques.goKnownWays() || !ways->anyOfLamps()) return nullptr;
    if (!setup.walker.lights().samplesSeenPoints()) return nullptr;
    return std::make_unique<const KnownWays>(setup.walker, ways,
                                             setup.settings.glassEffort.knownWays);
}

std::unique_ptr<const RefractedLamps> refractedLampsOf(const RenderSetup& setup) {
    if (!setup.techniques.refract()) return nullptr;
    if (!setup.walker.lights().samplesSeenPoints()) return nullptr;
    std::shared_ptr<const SmoothGlass> glass = setup.settings.smoothGlass;
    if (!glass) glass = std::make_shared<const SmoothGlass>(setup.scene);
    if (glass->empty()) return nullptr;
    return std::make_unique<const RefractedLamps>(setup.walker, std::move(glass),
                                                  setup.settings.glassEffort.refractions);
}

}  // namespace

BidirIntegrator::BidirIntegrator(const Scene& scene, const Camera& camera, Techniques techniques,
                                 Method& method, const RenderSettings& settings,
                                 const ThreadPool& threads)
    : setup_(scene, camera, techniques, settings, threads),
      method_(&method),
      workers_(threads, settings.limits.maxDepth),
      deltas_(scene.hasAny(mayBeSpecular)),
      ways_(waysOf(setup_)),
      chains_(chainsOf(setup_, ways_)),
      refractedLamps_(refractedLampsOf(setup_)),
      knownWays_(knownWaysOf(setup_, ways_)),
      eyePass_(setup_, lightPass_, pool_, photons_, chains_.get(), delivery_, workers_) {}

Iteration BidirIntegrator::begin(std::uint32_t number, std::span<Rgb> pixels,
                                 IterationStatistics& statistics, const std::atomic<bool>& cancel) {
    const double radius = radiusOf(number);
    return {number, *method_, freeze(number, radius), radius, pixels, statistics, cancel};
}

TechniqueCounts BidirIntegrator::freeze(std::uint32_t iteration, double mergeRadius) {
    TechniqueCounts counts;
    counts.hit = setup_.techniques.hits;
    counts.splats = setup_.techniques.splats ? double(setup_.lightPaths) : 0.0;
    const ConnectionDensity& density = method_->freeze(iteration);
    if (setup_.techniques.connects) counts.connectThrough(density, setup_.walker);
    counts.merges = merging().where;
    counts.mergeSamples = double(pooledSubpaths()) * mergeArea(mergeRadius);
    counts.refractedLamps = refractedLamps_.get();
    if (counts.merges == Merges::Nowhere) counts.knownWays = knownWays_.get();
    counts.sharing = method_->sharing();
    counts.rouletteDepth = setup_.settings.limits.rouletteDepth;
    return counts;
}

/// The merges that the method asks for, less those that this scene has no place for.
Merging BidirIntegrator::merging() const {
    const Merging asked = method_->merging();
    return asked.where == Merges::BetweenDeltas && !deltas_ ? Merging{} : asked;
}

/// The merging radius R. It begins with two footprints of a pixel: a smaller blur is not seen.
double BidirIntegrator::radiusOf(std::uint32_t iteration) {
    constexpr double kFootprints = 2.0;
    const Merging merged = merging();
    if (merged.where == Merges::Nowhere) return 0.0;
    if (merged.radius > 0.0) return lacuna::mergeRadius(merged.radius, iteration);
    if (!footprint_) footprint_ = medianFootprint(setup_.walker);
    return lacuna::mergeRadius(kFootprints * *footprint_, iteration);
}

/// M: light subpaths in the pool.
std::uint64_t BidirIntegrator::pooledSubpaths() const {
    const PoolRequest request = method_->pool();
    return request.perPixel ? setup_.filmPixels() : request.subpaths;
}

/// Sorts the pool's photons by place. Runs after the light pass.
void BidirIntegrator::findPhotons(const Iteration& iteration) {
    photons_ = {};
    if (iteration.counts.merges == Merges::Nowhere) return;
    PhaseTimer timer(iteration.statistics, "photons");
    photons_ = PhotonGrid(pool_.vertices(), pool_.photons(), iteration.mergeRadius);
    iteration.statistics.hold("photons", pool_.photons().size());
    iteration.statistics.hold("photon bytes", photons_.bytes());
}

IterationContext BidirIntegrator::contextFor(std::uint32_t generation,
                                             IterationStatistics& statistics) const {
    return {setup_.space, setup_.threads,      setup_.settings.seed,
            generation,   setup_.filmPixels(), statistics};
}

/// Number of the iteration among all, with the warm-ups of its block and of all blocks before it.
std::uint32_t BidirIntegrator::generationOf(std::uint32_t iteration) const {
    const std::uint64_t block = iteration / setup_.settings.blockIterations;
    return std::uint32_t(iteration + (block + 1) * std::uint64_t(method_->warmupIterations()));
}

LightPass::Purpose BidirIntegrator::poolAlone(StreamKind stream) const {
    return {stream, pooledSubpaths(), 0};
}

bool BidirIntegrator::beginBlock(std::uint64_t block, Method& fresh,
                                 const std::atomic<bool>& cancel, IterationStatistics& statistics) {
    PhaseTimer timer(statistics, "warm-up");
    method_ = &fresh;
    const auto warmups = std::uint64_t(method_->warmupIterations());
    for (std::uint64_t i = 0; i < warmups; ++i) {
        const auto number = std::uint32_t(block * warmups + i);
        const Iteration iteration = begin(number, {}, statistics, cancel);
        if (!lightPass_.run(iteration, poolAlone(StreamKind::Warmup), pool_)) return false;
        IterationContext context =
            contextFor(std::uint32_t(block * setup_.settings.blockIterations) + number, statistics);
        method_->prepare(pool_, context);
        method_->observe(pool_, context);
    }
    return true;
}

bool BidirIntegrator::render(std::uint32_t number, std::span<Rgb> pixels,
                             const std::atomic<bool>& cancel, IterationStatistics& statistics) {
    std::fill(pixels.begin(), pixels.end(), Rgb{});
    const Techniques& techniques = setup_.techniques;
    const Iteration iteration = begin(number, pixels, statistics, cancel);
    IterationContext context = contextFor(generationOf(number), statistics);
    if (coverage_) {
        PhaseTimer timer(statistics, "coverage");
        coverage_->addIteration(setup_, iteration);
    }
    {
        PhaseTimer timer(statistics, "light paths");
        LightPass::Purpose purpose = poolAlone(StreamKind::LightPath);
        if (techniques.splats) purpose.splats = setup_.lightPaths;
        if (!lightPass_.run(iteration, purpose, pool_)) {
            std::fill(pixels.begin(), pixels.end(), Rgb{});  // they hold a share of the splats only
            return false;
        }
    }
    if (pool_.subpaths() > 0) {
        statistics.hold("light vertices", pool_.vertices().size());
        statistics.hold("light vertex bytes", pool_.vertices().size_bytes());
    }
    {
        PhaseTimer timer(statistics, "prepare");
        method_->prepare(pool_, context);
    }
    findPhotons(iteration);
    const bool merges = iteration.counts.merges != Merges::Nowhere;
    if (techniques.hits || techniques.connects || merges) {
        PhaseTimer timer(statistics, "eye paths");
        if (!eyePass_.run(iteration)) return false;
    }
    {
        PhaseTimer timer(statistics, "observe");
        method_->observe(pool_, context);
    }
    delivery_.countIteration();
    return true;
}

BidirIntegrator::Replayed BidirIntegrator::replayEyePath(std::uint32_t number, int x, int y,
                                                         const PathObserver& observer) {
    const std::atomic<bool> never{false};
    IterationStatistics ignored;
    const Iteration iteration = begin(number, {}, ignored, never);
    if (pooledSubpaths() > 0) lightPass_.run(iteration, poolAlone(StreamKind::LightPath), pool_);
    findPhotons(iteration);
    IterationContext context = contextFor(generationOf(number), ignored);
    method_->prepare(pool_, context);
    TaskResult result;
    Rgb pixel;
    Worker& worker = workers_.own();
    const PathObserver before = delivery_.setObserver(observer);
    const std::size_t i = eyePass_.pixel(iteration, x, y, pixel, worker, result);
    delivery_.setObserver(before);
    return {worker.eye[i], worker.light[i]};
}

BidirIntegrator::Replayed BidirIntegrator::replayLightPath(std::uint32_t number, std::uint64_t path,
                                                           const PathObserver& observer) {
    const std::atomic<bool> never{false};
    IterationStatistics ignored;
    const Iteration iteration = begin(number, {}, ignored, never);
    TaskResult result;
    Worker& worker = workers_.own();
    const PathObserver before = delivery_.setObserver(observer);
    lightPass_.trace({&path, 1}, iteration, {StreamKind::LightPath, 0, setup_.lightPaths}, worker,
                     result);
    delivery_.setObserver(before);
    return {{}, worker.light[0]};
}

}  // namespace lacuna
