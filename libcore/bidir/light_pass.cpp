// (theory.md, "Counts")
#include "libcore/bidir/light_pass.h"

#include <algorithm>

#include "libcore/bidir/refracted_lamps.h"

namespace lacuna {

namespace {
constexpr std::uint64_t kPathsPerTask = 1024;
// Of a batch, between two additions to pool and picture. What few tasks leave is still in the cache
// then, and memory that the next batch can have.
constexpr std::uint64_t kTasksPerThread = 16;
constexpr std::uint64_t kMostTasks = 256;

std::size_t pooledVertices(std::span<const TaskResult> results) {
    std::size_t sum = 0;
    for (const TaskResult& r : results) sum += r.pooled.size();
    return sum;
}
}  // namespace

bool LightPass::run(const Iteration& iteration, const Purpose& purpose, LightPool& pool) {
    pool.reset(purpose.pooled, iteration.counts.merges);
    const std::uint64_t total = std::max(purpose.pooled, purpose.splats);
    const std::uint64_t batch =
        kPathsPerTask *
        std::min(kMostTasks, kTasksPerThread * std::uint64_t(setup_.threads.threads()));
    for (std::uint64_t begin = 0; begin < total; begin += batch) {
        const std::uint64_t end = std::min(total, begin + batch);
        std::vector<TaskResult> results((end - begin + kPathsPerTask - 1) / kPathsPerTask);
        memory_.resize(std::max(memory_.size(), results.size()));
        setup_.threads.forEach(results.size(), [&](std::size_t task) {
            if (iteration.cancel) return;
            delivery_.begin(results[task]);
            results[task].pooled.swap(memory_[task]);
            Worker& worker = workers_.own();
            const std::uint64_t first = begin + task * kPathsPerTask;
            const std::uint64_t last = std::min(end, first + kPathsPerTask);
            std::vector<std::uint64_t> together;
            for (std::uint64_t i = first; i < last; ++i) {
                if (!tracedByItsPixel(i, purpose)) together.push_back(i);
                if (together.size() < kTile && i + 1 < last) continue;
                trace(together, iteration, purpose, worker, results[task]);
                together.clear();
            }
        });
        if (iteration.cancel) return false;

        if (begin == 0 && purpose.pooled > 0) {
            const double traced = double(std::min(end, purpose.pooled));
            pool.reserve(double(pooledVertices(results)) * double(purpose.pooled) / traced);
        }
        for (std::size_t task = 0; task < results.size(); ++task) {
            TaskResult& r = results[task];
            pool.add(r.pooled, setup_.settings.limits.maxDepth, r.pooledLengths);
            r.pooled.clear();
            r.pooled.swap(memory_[task]);
        }
        delivery_.collect(results, iteration.statistics);
        delivery_.addSplats(results, iteration);
    }
    return true;
}

/// Where pixels trace light subpaths of their own, those of the crop are left to the eye pass.
bool LightPass::tracedByItsPixel(std::uint64_t number, const Purpose& purpose) const {
    if (!setup_.techniques.ownLightPath || number >= setup_.filmPixels()) return false;
    if (number < purpose.pooled) return false;
    const auto width = std::uint64_t(setup_.camera.film().width);
    return setup_.settings.crop.contains(int(number % width), int(number / width));
}

void LightPass::trace(std::span<const std::uint64_t> numbers, const Iteration& iteration,
                      const Purpose& purpose, Worker& worker, TaskResult& result) const {
    result.clock.start();
    worker.rngs.clear();
    worker.walks.clear();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        Rng& rng = worker.rngs.emplace_back(
            setup_.sampler.stream(iteration.number, purpose.stream, numbers[i]));
        const auto walk = setup_.walker.startLight(rng, worker.light[i]);
        if (walk) worker.walks.push_back(*walk);
    }
    setup_.walker.finish(worker.walks, result.tally);
    result.clock.lapOfWalks(kLightWalks);

    for (std::size_t i = 0; i < numbers.size(); ++i) {
        std::vector<PathVertex>& path = worker.light[i];
        const bool pooled = numbers[i] < purpose.pooled;
        const bool kept = pooled || setup_.techniques.ownLightPath;
        if (kept) label(path, iteration, result);
        if (pooled) result.pooled.insert(result.pooled.end(), path.begin(), path.end());
        if (pooled && setup_.techniques.ownLightPath) {
            result.pooledLengths.push_back(std::uint8_t(path.size()));
        }
        result.clock.lapOfWalks(kLightWalks);
        if (numbers[i] < purpose.splats) {
            splat(path, kept, numbers[i], worker.rngs[i], iteration, worker, result);
        }
    }
}

/// Sets what weights read of the subpath: labels, and next event's density through glass.
void LightPass::label(std::span<PathVertex> path, const Iteration& iteration,
                      TaskResult& result) const {
    iteration.counts.labelWalk(path);
    if (iteration.counts.refractedLamps) {
        iteration.counts.refractedLamps->look(path, result.tally);
    }
}

void LightPass::splat(std::span<PathVertex> path, bool labelled, std::uint64_t number, Rng& rng,
                      const Iteration& iteration, Worker& worker, TaskResult& result) const {
    const Walker& walker = setup_.walker;
    const PathVertex z0 = walker.sampleLens(rng);
    for (std::size_t s = 1; s <= path.size(); ++s) {
        const Subpath light = path.first(s);
        if (!light.back().connectable()) continue;
        const auto open = lensEdge(walker, light.back(), z0, setup_.settings.crop, result.tally);
        if (!open) continue;
        if (!labelled) label(path, iteration, result);  // only now: most paths are never seen
        labelled = true;
        const auto closed = closeSplat(walker, light, z0, *open, worker.fullPath);
        if (!closed) continue;
        const std::uint32_t pixel = setup_.cropIndex(int(closed->raster.x), int(closed->raster.y));
        delivery_.toSplats({*closed,
                            worker.fullPath,
                            {iteration.number, true, number},
                            pixel,
                            1.0 / double(setup_.lightPaths)},
                           iteration.counts, result);
    }
    result.clock.lap([] { return TechniqueGroup{}; });
}

}  // namespace lacuna
