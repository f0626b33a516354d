// (theory.md, "Counts")
#include "libcore/bidir/eye_pass.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>

namespace lacuna {

namespace {
constexpr int kPathsPerBatch = 1 << 18;  // between two additions of splats: bounds memory
/// Side of the squares whose pixels share walks.
constexpr int kSide = 4;
static_assert(kSide * kSide == kTile);
/// The technique group of a light subpath of s vertices with this eye subpath.
TechniqueGroup groupOf(std::size_t s, Subpath eye) {
    return TechniqueGroup::of(int(s), int(eye.size()), connectionOrder(eye));
}
}  // namespace

/// A block is a part of a row. Where walks are shared it is a square of the film; the squares shift from one iteration
/// to the next so that the picture has no seams.
EyePass::Blocks EyePass::blocksOf(const Iteration& iteration) const {
    const PixelRect& crop = setup_.settings.crop;
    if (!iteration.counts.sharing.any()) return {crop.x0, crop.y0, kTile, 1, crop};
    const int shift = int(iteration.number % std::uint32_t(kTile));
    const Camera::Film film = setup_.camera.film();
    return {crop.x0 - (crop.x0 + shift % kSide) % kSide,
            crop.y0 - (crop.y0 + shift / kSide) % kSide,
            kSide,
            kSide,
            {0, film.width, 0, film.height}};
}

PixelRect EyePass::Blocks::at(int x, int y) const {
    const int left = x - (x - x0) % width, top = y - (y - y0) % height;
    return {std::max(left, bounds.x0), std::min(left + width, bounds.x1), std::max(top, bounds.y0),
            std::min(top + height, bounds.y1)};
}

bool EyePass::run(const Iteration& iteration) const {
    const PixelRect& crop = setup_.settings.crop;
    const Target target{crop, iteration.pixels.data()};
    const Blocks blocks = blocksOf(iteration);
    const int tilesX = (crop.x1 - blocks.x0 + kTile - 1) / kTile;
    const int tilesY = (crop.y1 - blocks.y0 + kTile - 1) / kTile;
    const int rowsPerBatch = std::max(1, kPathsPerBatch / (kTile * kTile * tilesX));
    for (int row = 0; row < tilesY; row += rowsPerBatch) {
        const int rows = std::min(rowsPerBatch, tilesY - row);
        std::vector<TaskResult> results(std::size_t(rows) * std::size_t(tilesX));
        setup_.threads.forEach(results.size(), [&](std::size_t task) {
            if (iteration.cancel) return;
            delivery_.begin(results[task]);
            Worker& worker = workers_.own();
            const int x0 = blocks.x0 + int(task % std::size_t(tilesX)) * kTile;
            const int y0 = blocks.y0 + (row + int(task / std::size_t(tilesX))) * kTile;
            for (int y = y0; y < std::min(y0 + kTile, crop.y1); y += blocks.height) {
                for (int x = x0; x < std::min(x0 + kTile, crop.x1); x += blocks.width) {
                    block(iteration, blocks.at(x, y), target, worker, results[task]);
                }
            }
        });
        if (iteration.cancel) return false;
        delivery_.collect(results, iteration.statistics);
        delivery_.addSplats(results, iteration);
    }
    return true;
}

std::size_t EyePass::pixel(const Iteration& iteration, int x, int y, Rgb& value, Worker& worker,
                           TaskResult& result) const {
    const PixelRect alone{x, x + 1, y, y + 1};
    const bool shares = iteration.counts.sharing.any();
    const PixelRect pixels = shares ? blocksOf(iteration).at(x, y) : alone;
    block(iteration, pixels, {alone, &value}, worker, result);
    return std::size_t((y - pixels.y0) * pixels.width() + x - pixels.x0);
}

/// `pixels` are at most kTile.
void EyePass::block(const Iteration& iteration, const PixelRect& pixels, const Target& target,
                    Worker& worker, TaskResult& result) const {
    struct Place {
        int x, y;
        std::uint32_t inFilm;
    };
    std::array<Place, kTile> all;
    std::size_t count = 0;
    for (int y = pixels.y0; y < pixels.y1; ++y) {
        for (int x = pixels.x0; x < pixels.x1; ++x) all[count++] = {x, y, setup_.filmIndex(x, y)};
    }
    const auto places = std::span(all).first(count);
    // Each step is done for all pixels before the next step begins: the processor's first cache
    // holds the code of one step.
    const bool traced = setup_.techniques.ownLightPath && !pool_.findsSubpaths();
    if (traced) {
        std::array<std::uint64_t, kTile> numbers;
        std::ranges::transform(places, numbers.begin(), &Place::inFilm);
        const std::uint64_t splats = setup_.techniques.splats ? setup_.lightPaths : 0;
        lightPass_.trace(std::span(numbers).first(count), iteration,
                         {StreamKind::LightPath, 0, splats}, worker, result);
    }
    result.clock.start();
    worker.rngs.clear();
    worker.walks.clear();
    for (std::size_t i = 0; i < count; ++i) {
        const auto [x, y, inFilm] = places[i];
        Rng& rng = worker.rngs.emplace_back(
            setup_.sampler.stream(iteration.number, StreamKind::EyePath, inFilm));
        worker.walks.push_back(setup_.startEye(x, y, rng, worker.eye[i]));
        worker.walks.back().lends = iteration.counts.sharing.any();
    }
    setup_.walker.finish(worker.walks, result.tally);
    for (std::size_t i = 0; i < count; ++i) iteration.counts.labelWalk(worker.eye[i]);
    result.clock.lapOfWalks(kEyeWalks);
    worker.paths.clear();
    for (std::size_t i = 0; i < count; ++i) {
        const auto [x, y, inFilm] = places[i];
        const Subpath own = traced                  ? worker.light[i]
                            : pool_.findsSubpaths() ? pool_.subpath(inFilm)
                                                    : Subpath{};
        worker.paths.push_back({worker.eye[i],
                                own,
                                {iteration.number, false, inFilm},
                                setup_.cropIndex(x, y),
                                target.at(x, y)});
    }
    if (iteration.counts.sharing.any()) {
        closeTogether(worker.paths, iteration, worker, result);
    } else {
        for (const PixelPaths& paths : worker.paths) closeAlone(paths, iteration, worker, result);
    }
}

void EyePass::closeAlone(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                         TaskResult& result) const {
    Joints& joints = worker.joints[0];
    select(paths, joints, iteration, result);
    open(paths, joints, iteration, result);
    result.clock.start();
    close(paths, joints, {2, paths.eye.size()}, iteration, worker, result);
    searchBehindGlass(paths, iteration, worker, result);
}

Rgb EyePass::closeAt(const Ending& ending, Subpath eye, const PixelPaths& paths,
                     const Iteration& iteration, Worker& worker, TaskResult& result,
                     double scale) const {
    Rgb value;
    if (!ending.open) {
        const auto closed = closeHit(setup_.walker, eye, worker.fullPath);
        if (closed) value = deliver(*closed, paths, iteration, worker, result, scale);
        result.clock.lap([&] { return groupOf(0, eye); });
        return value;
    }
    const OpenConnection& open = *ending.open;
    const auto closed = closeConnection(
        setup_.walker, {open.light, eye, open.edge, open.lightAsEye, open.eyeAsLight},
        worker.fullPath);
    if (closed) {
        value = deliver(*closed, paths, iteration, worker, result, scale * ending.openedBy->weight,
                        ending.openedBy);
    }
    result.clock.lap([&] { return groupOf(open.light.size(), eye); });
    return value;
}

void EyePass::close(const PixelPaths& paths, const Joints& joints, Ends ends,
                    const Iteration& iteration, Worker& worker, TaskResult& result) const {
    forEachEnding(
        paths, joints, ends,
        [&](const Ending& ending) {
            closeAt(ending, paths.eye.first(ending.t), paths, iteration, worker, result);
        },
        [&](std::size_t t) { merge(paths, paths.eye.first(t), iteration, worker, result); });
}

/// Techniques over mirrors and through glass, for paths that have no edge to connect.
void EyePass::searchBehindGlass(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                                TaskResult& result) const {
    // Merges already make the paths of chains.
    if (chains_ && iteration.counts.merges == Merges::Nowhere) {
        chain(paths, iteration, worker, result);
    }
    if (iteration.counts.refractedLamps) refract(paths, iteration, worker, result);
    if (iteration.counts.knownWays) goKnownWays(paths, iteration, worker, result);
}

/// Merges an eye subpath's last vertex with the photons around it.
void EyePass::merge(const PixelPaths& paths, Subpath eye, const Iteration& iteration,
                    Worker& worker, TaskResult& result) const {
    if (photons_.empty() || !asksForPhotons(eye, iteration.counts.merges)) return;
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
        // K / n_m: mergeSamples is n_m pi R^2, and the kernel K is constant over the disk.
        const double scale = 1.0 / iteration.counts.mergeSamples;
        deliver(*closed, paths, iteration, worker, result, scale);
    }
    result.clock.lap([&] { return TechniqueGroup::ofMerge(connectionOrder(eye)); });
}

/// Joins the eye path's vertices with lights that no ray can hit, over mirrors and
/// through smooth glass.
void EyePass::chain(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                    TaskResult& result) const {
    Rng rng = setup_.sampler.stream(iteration.number, StreamKind::Chain, paths.sample.number);
    for (std::size_t t = 2; t <= paths.eye.size(); ++t) {
        const Subpath eye = paths.eye.first(t);
        if (!SpecularChains::begin(eye, iteration.counts)) continue;
        const auto bring = [&](const Closed& closed) {
            deliver(closed, paths, iteration, worker, result);
        };
        // Passed by reference: a copy would be allocated.
        chains_->sample(eye, rng, result.tally, worker.chain, worker.fullPath, std::ref(bring));
        result.clock.lap([&] { return TechniqueGroup::ofChain(connectionOrder(eye)); });
    }
}

/// Joins the eye path's vertices with lamps and the sky behind smooth glass.
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

/// Joins the eye path's vertices with lamps and the sky over chains that light is known to take.
void EyePass::goKnownWays(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                          TaskResult& result) const {
    Rng rng = setup_.sampler.stream(iteration.number, StreamKind::KnownWay, paths.sample.number);
    for (std::size_t t = 2; t <= paths.eye.size(); ++t) {
        const Subpath eye = paths.eye.first(t);
        const auto bring = [&](const Closed& closed) {
            deliver(closed, paths, iteration, worker, result);
        };
        iteration.counts.knownWays->sample(eye, iteration.counts, rng, result.tally, worker.chain,
                                           worker.fullPath, std::ref(bring));
        result.clock.lap([&] { return TechniqueGroup::ofRefraction(connectionOrder(eye)); });
    }
}

/// Picks light vertices for all vertices of the path before the first one is connected. They lie
/// anywhere in memory, and the picked ones are fetched meanwhile.
void EyePass::select(const PixelPaths& paths, Joints& joints, const Iteration& iteration,
                     TaskResult& result) const {
    joints.proposals.clear();
    joints.proposalEnds.assign(paths.eye.size() + 1, 0);
    if (!setup_.techniques.connects) return;
    const auto filmIndex = std::uint32_t(paths.sample.number);
    Rng rng = setup_.sampler.stream(iteration.number, StreamKind::Connection, filmIndex);
    for (std::size_t t = 2; t <= paths.eye.size(); ++t) {
        const PathVertex& z = paths.eye[t - 1];
        const std::size_t before = joints.proposals.proposals().size();
        result.clock.start();
        if (!z.infinite() && z.connectable() && int(t) <= setup_.settings.limits.maxDepth) {
            rng.toDimension(dimension::ofPicks(std::uint32_t(t)));
            iteration.method.select({z, paths.eye.first(t), paths.ownLight, filmIndex,
                                     iteration.number, setup_.walker, setup_.space, result.tally},
                                    rng, joints.proposals);
        }
        joints.proposalEnds[t] = joints.proposals.proposals().size();
        result.clock.lapAmong(joints.proposalEnds[t] - before, [&](std::size_t i) {
            const Subpath light = joints.proposals.proposals()[before + i].light;
            return groupOf(light.size(), paths.eye.first(t));
        });
    }
}

/// Traces the shadow rays of all connections before the first one is weighed. The rest of the light
/// subpaths is fetched meanwhile, and labels are looked up together.
void EyePass::open(const PixelPaths& paths, Joints& joints, const Iteration& iteration,
                   TaskResult& result) const {
    joints.open.clear();
    joints.openedBy.clear();
    const std::span<const Proposal> proposals = joints.proposals.proposals();
    result.clock.start();
    std::size_t next = 0;
    for (std::size_t t = 2; t <= paths.eye.size(); ++t) {
        for (; next < joints.proposalEnds[t]; ++next) {
            const Subpath light = proposals[next].light;
            if (int(light.size() + t) - 1 > setup_.settings.limits.maxDepth) continue;
            const auto edge =
                connectingEdge(setup_.walker, light.back(), paths.eye[t - 1], result.tally);
            result.clock.lap([&] { return groupOf(light.size(), paths.eye.first(t)); });
            if (!edge) continue;
            for (const PathVertex& v : light.first(light.size() - 1)) prefetch(v);
            joints.open.push_back({light, paths.eye.first(t), *edge});
            joints.openedBy.push_back(&proposals[next]);
        }
    }
    iteration.counts.labelEnds(joints.open);
    result.clock.lapAmong(joints.open.size(), [&](std::size_t i) {
        return groupOf(joints.open[i].light.size(), joints.open[i].eye);
    });
}

}  // namespace lacuna
