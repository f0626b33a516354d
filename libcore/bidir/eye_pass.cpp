#include "libcore/bidir/eye_pass.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace lacuna {

namespace {
constexpr int kPathsPerBatch = 1 << 18;  // between two additions of splats: bounds memory
/// Of the vertices that chains begin at, those that search where that is nearly every one: searches at
/// all of them would take more than three times as long as the rest of the path.
constexpr double kShareWithoutSplats = 0.25;

/// Of a light subpath of s vertices with this eye subpath.
TechniqueGroup groupOf(std::size_t s, Subpath eye) {
    return TechniqueGroup::of(int(s), int(eye.size()), connectionOrder(eye));
}
}  // namespace

bool EyePass::run(const Iteration& iteration) const {
    const PixelRect& crop = setup_.settings.crop;
    const int tilesX = (crop.width() + kTile - 1) / kTile;
    const int tilesY = (crop.height() + kTile - 1) / kTile;
    const int rowsPerBatch = std::max(1, kPathsPerBatch / (kTile * kTile * tilesX));
    for (int row = 0; row < tilesY; row += rowsPerBatch) {
        const int rows = std::min(rowsPerBatch, tilesY - row);
        std::vector<TaskResult> results(std::size_t(rows) * std::size_t(tilesX));
        setup_.threads.forEach(results.size(), [&](std::size_t task) {
            if (iteration.cancel) return;
            delivery_.begin(results[task]);
            Worker& worker = workers_.own();
            const int x0 = crop.x0 + int(task % std::size_t(tilesX)) * kTile;
            const int y0 = crop.y0 + (row + int(task / std::size_t(tilesX))) * kTile;
            const auto count = std::size_t(std::min(kTile, crop.x1 - x0));
            for (int y = y0; y < std::min(y0 + kTile, crop.y1); ++y) {
                pixelRow(iteration, x0, y, iteration.pixels.subspan(setup_.cropIndex(x0, y), count),
                         worker, results[task]);
            }
        });
        if (iteration.cancel) return false;
        delivery_.collect(results, iteration.statistics);
        delivery_.addSplats(results, iteration);
    }
    return true;
}

void EyePass::pixelRow(const Iteration& iteration, int x0, int y, std::span<Rgb> pixels,
                       Worker& worker, TaskResult& result) const {
    const std::uint32_t filmIndex = setup_.filmIndex(x0, y);
    // One thing after the other for all pixels, and not all things for one pixel: the processor's
    // first cache holds the code of one of them.
    const bool traced = setup_.techniques.ownLightPath && !pool_.findsSubpaths();
    if (traced) {
        std::array<std::uint64_t, kTile> numbers;
        std::iota(numbers.begin(), numbers.end(), std::uint64_t(filmIndex));
        const std::uint64_t splats = setup_.techniques.splats ? setup_.lightPaths : 0;
        lightPass_.trace(std::span(numbers).first(pixels.size()), iteration,
                         {StreamKind::LightPath, 0, splats}, worker, result);
    }
    result.clock.start();
    worker.rngs.clear();
    worker.walks.clear();
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        Rng& rng = worker.rngs.emplace_back(
            setup_.sampler.stream(iteration.number, StreamKind::EyePath, filmIndex + i));
        worker.walks.push_back(setup_.startEye(x0 + int(i), y, rng, worker.eye[i]));
    }
    setup_.walker.finish(worker.walks, result.tally);
    for (std::uint32_t i = 0; i < pixels.size(); ++i) iteration.counts.labelWalk(worker.eye[i]);
    result.clock.lapOfWalks(kEyeWalks);
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        const Subpath own = traced                  ? worker.light[i]
                            : pool_.findsSubpaths() ? pool_.subpath(filmIndex + i)
                                                    : Subpath{};
        close({worker.eye[i],
               own,
               {iteration.number, false, filmIndex + i},
               setup_.cropIndex(x0 + int(i), y),
               pixels[i]},
              iteration, worker, result);
    }
}

void EyePass::close(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                    TaskResult& result) const {
    select(paths, iteration, worker, result);
    open(paths, iteration, worker, result);
    TechniqueClock& clock = result.clock;
    clock.start();
    std::size_t next = 0;
    for (std::size_t t = 2; t <= paths.eye.size(); ++t) {
        const Subpath eye = paths.eye.first(t);
        if (setup_.techniques.hits && eye.back().light != kNone) {
            const auto closed = closeHit(setup_.walker, eye, worker.fullPath);
            if (closed) deliver(*closed, paths, iteration, worker, result);
            clock.lap([&] { return groupOf(0, eye); });
        }
        for (; next < worker.open.size() && worker.open[next].eye.size() == t; ++next) {
            const OpenConnection& open = worker.open[next];
            const auto closed = closeConnection(setup_.walker, open, worker.fullPath);
            const Proposal* proposal = worker.openedBy[next];
            if (closed)
                deliver(*closed, paths, iteration, worker, result, proposal->weight, proposal);
            clock.lap([&] { return groupOf(open.light.size(), eye); });
        }
        if (!photons_.empty() && asksForPhotons(eye, iteration.counts.merges)) {
            merge(paths, eye, iteration, worker, result);
            clock.lap([&] { return TechniqueGroup::ofMerge(connectionOrder(eye)); });
        }
    }
    // Merges make those paths as well.
    if (chains_ && iteration.counts.merges == Merges::Nowhere) {
        chain(paths, iteration, worker, result);
    }
    if (iteration.counts.refractedLamps) refract(paths, iteration, worker, result);
}

/// An eye subpath's last vertex with the photons around it.
void EyePass::merge(const PixelPaths& paths, Subpath eye, const Iteration& iteration,
                    Worker& worker, TaskResult& result) const {
    const PathVertex& z = eye.back();
    worker.photons.clear();
    photons_.find(z.position, worker.photons);
    for (const std::uint32_t i : worker.photons) prefetch(pool_.vertices()[i]);
    for (const std::uint32_t i : worker.photons) {
        const Subpath light = pool_.prefixOf(i);
        const int edges = int(light.size() + eye.size()) - 2;
        if (edges > setup_.settings.limits.maxDepth || !onSameSurface(light.back(), z)) continue;
        const auto closed = closeMerge(setup_.walker, light, eye, worker.fullPath);
        if (!closed) continue;
        // By the photons' number and the kernel's area, constant over it.
        const double scale = 1.0 / iteration.counts.mergeSamples;
        deliver(*closed, paths, iteration, worker, result, scale);
    }
}

/// The eye path's vertices with lights that no ray can hit, over mirrors and through smooth glass.
void EyePass::chain(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                    TaskResult& result) const {
    const double share = iteration.counts.onlyDirect() ? kShareWithoutSplats : 1.0;
    Rng rng = setup_.sampler.stream(iteration.number, StreamKind::Chain, paths.sample.number);
    for (std::size_t t = 2; t <= paths.eye.size(); ++t) {
        const Subpath eye = paths.eye.first(t);
        if (!SpecularChains::begin(eye, iteration.counts)) continue;
        if (share < 1.0 && rng.uniformDouble() >= share) continue;
        const auto closed = chains_->sample(eye, rng, result.tally, worker.chain, worker.fullPath);
        if (closed) deliver(*closed, paths, iteration, worker, result, 1.0 / share);
        result.clock.lap([&] { return TechniqueGroup::ofChain(connectionOrder(eye)); });
    }
}

/// The eye path's vertices with lamps and the sky behind smooth glass.
void EyePass::refract(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                      TaskResult& result) const {
    const RefractedLamps& lamps = *iteration.counts.refractedLamps;
    std::optional<Rng> rng;
    for (std::size_t t = 2; t <= paths.eye.size(); ++t) {
        const Subpath eye = paths.eye.first(t);
        if (!lamps.mayBring(eye.back())) continue;
        if (!rng) {
            rng = setup_.sampler.stream(iteration.number, StreamKind::Refraction,
                                        paths.sample.number);
        }
        const auto closed = lamps.sample(eye, *rng, result.tally, worker.chain, worker.fullPath);
        if (closed) deliver(*closed, paths, iteration, worker, result);
        result.clock.lap([&] { return TechniqueGroup::ofRefraction(connectionOrder(eye)); });
    }
}

/// For all vertices of the path before the first one is connected: light vertices lie anywhere in
/// memory, and those that were picked are on their way from there meanwhile.
void EyePass::select(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                     TaskResult& result) const {
    worker.proposals.clear();
    worker.proposalEnds.assign(paths.eye.size() + 1, 0);
    if (!setup_.techniques.connects) return;
    const auto filmIndex = std::uint32_t(paths.sample.number);
    Rng rng = setup_.sampler.stream(iteration.number, StreamKind::Connection, filmIndex);
    for (std::size_t t = 2; t <= paths.eye.size(); ++t) {
        const PathVertex& z = paths.eye[t - 1];
        const std::size_t before = worker.proposals.proposals().size();
        result.clock.start();
        if (!z.infinite() && z.connectable() && int(t) <= setup_.settings.limits.maxDepth) {
            rng.toDimension(dimension::ofPicks(std::uint32_t(t)));
            iteration.method.select({z, paths.eye.first(t), paths.ownLight, filmIndex,
                                     iteration.number, setup_.walker, setup_.space, result.tally},
                                    rng, worker.proposals);
        }
        worker.proposalEnds[t] = worker.proposals.proposals().size();
        result.clock.lapAmong(worker.proposalEnds[t] - before, [&](std::size_t i) {
            const Subpath light = worker.proposals.proposals()[before + i].light;
            return groupOf(light.size(), paths.eye.first(t));
        });
    }
}

/// Likewise before the first one is weighed: the rest of the light subpaths, and labels.
void EyePass::open(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                   TaskResult& result) const {
    worker.open.clear();
    worker.openedBy.clear();
    const std::span<const Proposal> proposals = worker.proposals.proposals();
    result.clock.start();
    std::size_t next = 0;
    for (std::size_t t = 2; t <= paths.eye.size(); ++t) {
        for (; next < worker.proposalEnds[t]; ++next) {
            const Subpath light = proposals[next].light;
            if (int(light.size() + t) - 1 > setup_.settings.limits.maxDepth) continue;
            const auto edge =
                connectingEdge(setup_.walker, light.back(), paths.eye[t - 1], result.tally);
            result.clock.lap([&] { return groupOf(light.size(), paths.eye.first(t)); });
            if (!edge) continue;
            for (const PathVertex& v : light.first(light.size() - 1)) prefetch(v);
            worker.open.push_back({light, paths.eye.first(t), *edge});
            worker.openedBy.push_back(&proposals[next]);
        }
    }
    iteration.counts.labelEnds(worker.open);
    result.clock.lapAmong(worker.open.size(), [&](std::size_t i) {
        return groupOf(worker.open[i].light.size(), worker.open[i].eye);
    });
}

}  // namespace lacuna
