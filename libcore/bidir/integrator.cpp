#include "libcore/bidir/integrator.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace lacuna {

namespace {
constexpr std::uint64_t kPathsPerChunk = 1024;     // light subpaths per task
constexpr std::uint64_t kPathsPerBatch = 1 << 18;  // between two additions of splats: bounds memory
constexpr int kTile = 16;                          // eye paths: tiles of kTile^2 pixels
constexpr std::size_t kReplaysKept = IterationStatistics::kReplaysKept;
}  // namespace

/// A splat's technique and its value without the weight: only where --techniques asks for it.
struct TechniqueSplat {
    int s;
    Splat weighted;
    Rgb unweighted;
};

/// What one task leaves behind; merged in the order of tasks.
struct BidirIntegrator::Chunk {
    std::vector<Splat> splats;
    std::vector<std::uint64_t> splatPaths;  // by splat: its light subpath
    std::vector<TechniqueSplat> techniqueSplats;
    std::vector<PathVertex> vertices;  // of the subpaths that go into the pool
    RayTally tally;
    std::vector<RecordedRay> rays;
    std::uint64_t invalidSamples = 0;
    std::vector<std::string> invalidReplays;
};

namespace {
/// What --replay takes for a light subpath.
std::string lightReplay(std::uint64_t path, std::uint32_t iteration) {
    return "light:" + std::to_string(path) + "," + std::to_string(iteration);
}
}  // namespace

/// Scratch memory of one thread: the subpaths of a tile's row of pixels, or of a batch.
struct BidirIntegrator::Worker {
    std::array<std::vector<PathVertex>, kTile> eye, light;
    std::vector<Rng> rngs;  // by subpath
    std::vector<Walk> walks;
    ProposalSink proposals;                 // for all vertices of an eye path
    std::vector<std::size_t> proposalEnds;  // by t: how many there are up to z_{t-1}
    std::vector<OpenConnection> open;       // of the proposals, those that are seen
    std::vector<const Proposal*> openedBy;  // by open connection
    FullPath path;
};

BidirIntegrator::BidirIntegrator(const Scene& scene, const Camera& camera, TechniqueSet techniques,
                                 Method& method, const RenderSettings& settings,
                                 const ThreadPool& pool)
    : scene_(scene),
      camera_(camera),
      techniqueSet_(techniques),
      method_(method),
      settings_(settings),
      threads_(pool),
      walker_(scene, camera, settings.limits),
      lightPaths_(settings.lightPaths
                      ? settings.lightPaths
                      : std::uint64_t(camera.film().width) * std::uint64_t(camera.film().height)) {
    for (int i = 0; i < pool.threads(); ++i) {
        workers_.push_back(std::make_unique<Worker>());
        for (auto& path : workers_.back()->eye) {
            path.reserve(std::size_t(settings.limits.maxDepth) + 1);
        }
        for (auto& path : workers_.back()->light) {
            path.reserve(std::size_t(settings.limits.maxDepth) + 1);
        }
        workers_.back()->rngs.reserve(kTile);  // walks point to them
    }
}

BidirIntegrator::~BidirIntegrator() = default;

Techniques BidirIntegrator::freeze(std::uint32_t iteration) {
    Techniques t;
    t.hit = techniqueSet_.hits;
    t.splats = techniqueSet_.splats ? double(lightPaths_) : 0.0;
    const ConnectionDensity& density = method_.freeze(iteration);
    if (techniqueSet_.connects) t.connectThrough(density);
    t.rouletteDepth = settings_.limits.rouletteDepth;
    return t;
}

IterationContext BidirIntegrator::context(IterationStatistics& statistics) const {
    const Camera::Film film = camera_.film();
    return {space_, threads_, settings_.seed,
            std::uint64_t(film.width) * std::uint64_t(film.height), statistics};
}

bool BidirIntegrator::warmUp(const std::atomic<bool>& cancel, IterationStatistics& statistics) {
    PhaseTimer timer(statistics, "warm-up");
    for (int i = 0; i < method_.warmupIterations(); ++i) {
        techniques_ = freeze(std::uint32_t(i));
        if (!lightPass(std::uint32_t(i), StreamKind::Warmup, false, cancel, statistics)) {
            return false;
        }
        IterationContext context = this->context(statistics);
        method_.prepare(pool_, context);
        method_.observe(pool_, context);
    }
    return true;
}

bool BidirIntegrator::render(std::uint32_t iteration, std::span<Rgb> pixels,
                             const std::atomic<bool>& cancel, IterationStatistics& statistics) {
    pixels_ = pixels;
    std::fill(pixels_.begin(), pixels_.end(), Rgb{});
    techniques_ = freeze(iteration);
    IterationContext context = this->context(statistics);
    {
        PhaseTimer timer(statistics, "light paths");
        if (!lightPass(iteration, StreamKind::LightPath, true, cancel, statistics)) return false;
    }
    if (pool_.subpaths() > 0) {
        statistics.hold("light vertices", pool_.vertices().size());
        statistics.hold("light vertex bytes", pool_.vertices().size_bytes());
    }
    {
        PhaseTimer timer(statistics, "prepare");
        method_.prepare(pool_, context);
    }
    if (techniqueSet_.hits || techniqueSet_.connects) {
        PhaseTimer timer(statistics, "eye paths");
        if (!eyePass(iteration, cancel, statistics)) return false;
    }
    {
        PhaseTimer timer(statistics, "observe");
        method_.observe(pool_, context);
    }
    if (techniqueFilm_) techniqueFilm_->countIteration();
    return true;
}

bool BidirIntegrator::lightPass(std::uint32_t iteration, StreamKind kind, bool splat,
                                const std::atomic<bool>& cancel, IterationStatistics& statistics) {
    const std::uint64_t pooled = method_.pool().subpaths;
    const bool splats = splat && techniqueSet_.splats;
    const std::uint64_t total = std::max(pooled, splats ? lightPaths_ : 0);
    pool_.reset(pooled);

    // Where pixels trace their own light subpaths, those are left to the eye pass.
    const int filmWidth = camera_.film().width;
    const auto filmPixels = std::uint64_t(filmWidth) * std::uint64_t(camera_.film().height);
    const auto tracedByPixel = [&](std::uint64_t i) {
        return techniqueSet_.ownLightPath && i < filmPixels &&
               settings_.crop.contains(int(i % std::uint64_t(filmWidth)),
                                       int(i / std::uint64_t(filmWidth)));
    };

    for (std::uint64_t begin = 0; begin < total; begin += kPathsPerBatch) {
        const std::uint64_t end = std::min(total, begin + kPathsPerBatch);
        std::vector<Chunk> chunks((end - begin + kPathsPerChunk - 1) / kPathsPerChunk);
        threads_.forEach(chunks.size(), [&](std::size_t c) {
            if (cancel) return;
            Chunk& chunk = chunks[c];
            if (recording_) chunk.tally.recording = &chunk.rays;
            Worker& worker = *workers_[std::size_t(threads_.workerIndex())];
            const std::uint64_t first = begin + c * kPathsPerChunk;
            const std::uint64_t last = std::min(end, first + kPathsPerChunk);
            std::vector<std::uint64_t> batch;
            for (std::uint64_t i = first; i < last; ++i) {
                if (!tracedByPixel(i)) batch.push_back(i);
                if (batch.size() < kTile && i + 1 < last) continue;
                traceLightPaths(batch, iteration, kind, worker, chunk);
                for (std::size_t b = 0; b < batch.size(); ++b) {
                    std::vector<PathVertex>& path = worker.light[b];
                    if (batch[b] < pooled) {
                        techniques_.tag(path);
                        chunk.vertices.insert(chunk.vertices.end(), path.begin(), path.end());
                    }
                    if (splats && batch[b] < lightPaths_) {
                        splatLightPath(path, iteration, batch[b], worker.rngs[b], worker, chunk);
                    }
                }
                batch.clear();
            }
        });
        if (cancel) return false;

        for (const Chunk& chunk : chunks) pool_.add(chunk.vertices, settings_.limits.maxDepth);
        collect(chunks, iteration, statistics);
    }
    return true;
}

bool BidirIntegrator::eyePass(std::uint32_t iteration, const std::atomic<bool>& cancel,
                              IterationStatistics& statistics) {
    const PixelRect& crop = settings_.crop;
    const int tilesX = (crop.width() + kTile - 1) / kTile;
    const int tilesY = (crop.height() + kTile - 1) / kTile;
    // Tile rows at a time: bounds the memory of splats.
    const int rowsPerBatch =
        std::max(1, int(kPathsPerBatch / std::uint64_t(kTile * kTile * tilesX)));
    for (int row = 0; row < tilesY; row += rowsPerBatch) {
        const int rows = std::min(rowsPerBatch, tilesY - row);
        std::vector<Chunk> chunks(std::size_t(rows) * std::size_t(tilesX));
        threads_.forEach(chunks.size(), [&](std::size_t c) {
            if (cancel) return;
            Chunk& chunk = chunks[c];
            if (recording_) chunk.tally.recording = &chunk.rays;
            Worker& worker = *workers_[std::size_t(threads_.workerIndex())];
            const int x0 = crop.x0 + int(c % std::size_t(tilesX)) * kTile;
            const int y0 = crop.y0 + (row + int(c / std::size_t(tilesX))) * kTile;
            for (int y = y0; y < std::min(y0 + kTile, crop.y1); ++y) {
                const std::size_t first = std::size_t(y - crop.y0) * std::size_t(crop.width()) +
                                          std::size_t(x0 - crop.x0);
                const int count = std::min(kTile, crop.x1 - x0);
                pixelRow(iteration, x0, y, worker, chunk,
                         pixels_.subspan(first, std::size_t(count)));
            }
        });
        if (cancel) return false;
        collect(chunks, iteration, statistics);
    }
    return true;
}

void BidirIntegrator::traceLightPaths(std::span<const std::uint64_t> indices,
                                      std::uint32_t iteration, StreamKind kind, Worker& worker,
                                      Chunk& chunk) {
    worker.rngs.clear();
    worker.walks.clear();
    for (std::size_t i = 0; i < indices.size(); ++i) {
        Rng& rng = worker.rngs.emplace_back(settings_.seed, iteration, kind, indices[i]);
        const auto walk = walker_.startLight(rng, worker.light[i]);
        if (walk) worker.walks.push_back(*walk);
    }
    walker_.finish(worker.walks, chunk.tally);
}

void BidirIntegrator::pixelRow(std::uint32_t iteration, int x0, int y, Worker& worker, Chunk& chunk,
                               std::span<Rgb> pixels) {
    const auto filmIndex =
        std::uint32_t(y) * std::uint32_t(camera_.film().width) + std::uint32_t(x0);
    // One thing after the other for all pixels, and not all things for one pixel: the processor's
    // first cache holds the code of one of them.
    if (techniqueSet_.ownLightPath) {
        std::array<std::uint64_t, kTile> indices;
        std::iota(indices.begin(), indices.end(), std::uint64_t(filmIndex));
        traceLightPaths(std::span(indices).first(pixels.size()), iteration, StreamKind::LightPath,
                        worker, chunk);
        for (std::uint32_t i = 0; i < pixels.size(); ++i) {
            techniques_.tag(worker.light[i]);
            if (techniqueSet_.splats && filmIndex + i < lightPaths_) {
                splatLightPath(worker.light[i], iteration, filmIndex + i, worker.rngs[i], worker,
                               chunk);
            }
        }
    }
    worker.rngs.clear();
    worker.walks.clear();
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        Rng& rng =
            worker.rngs.emplace_back(settings_.seed, iteration, StreamKind::EyePath, filmIndex + i);
        const float jitterX = rng.uniform(), jitterY = rng.uniform();
        worker.walks.push_back(walker_.startEye({float(x0 + int(i)) + jitterX, float(y) + jitterY},
                                                rng, worker.eye[i]));
    }
    walker_.finish(worker.walks, chunk.tally);
    for (std::uint32_t i = 0; i < pixels.size(); ++i) techniques_.tag(worker.eye[i]);
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        const Subpath light = techniqueSet_.ownLightPath ? worker.light[i] : Subpath{};
        closeEyePath(iteration, worker.eye[i], light, x0 + int(i), y, worker, chunk, pixels[i]);
    }
}

void BidirIntegrator::closeEyePath(std::uint32_t iteration, Subpath path, Subpath light, int x,
                                   int y, Worker& worker, Chunk& chunk, Rgb& pixel) {
    const PixelRect& crop = settings_.crop;
    const auto filmIndex =
        std::uint32_t(y) * std::uint32_t(camera_.film().width) + std::uint32_t(x);
    const auto pixelIndex =
        std::uint32_t(y - crop.y0) * std::uint32_t(crop.width()) + std::uint32_t(x - crop.x0);

    select(iteration, path, light, filmIndex, worker);
    open(path, worker, chunk);
    std::size_t next = 0;
    for (std::size_t t = 2; t <= path.size(); ++t) {
        const Subpath eye = path.first(t);
        if (techniqueSet_.hits && eye.back().light != kNone) {
            if (const auto closed = closeHit(walker_, eye, worker.path)) {
                deliver(*closed, nullptr, 1.0, iteration, filmIndex, pixelIndex, &pixel, worker,
                        chunk);
            }
        }
        for (; next < worker.open.size() && worker.open[next].eye.size() == t; ++next) {
            const auto closed = closeConnection(walker_, worker.open[next], worker.path);
            if (!closed) continue;
            const Proposal* proposal = worker.openedBy[next];
            deliver(*closed, proposal, proposal->weight, iteration, filmIndex, pixelIndex, &pixel,
                    worker, chunk);
        }
    }
}

/// For all vertices of the path before the first one is connected: light vertices lie anywhere in
/// memory, and those that were picked are on their way from there meanwhile.
void BidirIntegrator::select(std::uint32_t iteration, Subpath path, Subpath light,
                             std::uint32_t filmIndex, Worker& worker) const {
    worker.proposals.clear();
    worker.proposalEnds.assign(path.size() + 1, 0);
    if (!techniqueSet_.connects) return;
    Rng rng(settings_.seed, iteration, StreamKind::Connection, filmIndex);
    for (std::size_t t = 2; t <= path.size(); ++t) {
        const PathVertex& z = path[t - 1];
        if (!z.infinite() && z.connectable() && int(t) <= settings_.limits.maxDepth) {
            method_.select({z, path.first(t), light, filmIndex, iteration, walker_}, rng,
                           worker.proposals);
        }
        worker.proposalEnds[t] = worker.proposals.proposals().size();
    }
}

/// Likewise before the first one is weighed: the rest of the light subpaths, and tags.
void BidirIntegrator::open(Subpath path, Worker& worker, Chunk& chunk) const {
    worker.open.clear();
    worker.openedBy.clear();
    const std::span<const Proposal> proposals = worker.proposals.proposals();
    std::size_t next = 0;
    for (std::size_t t = 2; t <= path.size(); ++t) {
        for (; next < worker.proposalEnds[t]; ++next) {
            const Subpath light = proposals[next].light;
            if (int(light.size() + t) - 1 > settings_.limits.maxDepth) continue;
            const auto edge = openConnection(walker_, light.back(), path[t - 1], chunk.tally);
            if (!edge) continue;
            for (const PathVertex& v : light.first(light.size() - 1)) prefetch(v);
            worker.open.push_back({light, path.first(t), *edge, {}});
            worker.openedBy.push_back(&proposals[next]);
        }
    }
    techniques_.tagAcross(worker.open);
}

void BidirIntegrator::splatLightPath(std::span<PathVertex> path, std::uint32_t iteration,
                                     std::uint64_t index, Rng& rng, Worker& worker, Chunk& chunk) {
    const PixelRect& crop = settings_.crop;
    const PathVertex z0 = walker_.sampleLens(rng);
    for (std::size_t s = 1; s <= path.size(); ++s) {
        const Subpath light = path.first(s);
        if (!light.back().connectable()) continue;
        const auto closed = closeSplat(walker_, light, z0, crop, chunk.tally, worker.path);
        if (!closed) continue;
        const int x = int(closed->raster.x), y = int(closed->raster.y);
        const auto pixel =
            std::uint32_t(y - crop.y0) * std::uint32_t(crop.width()) + std::uint32_t(x - crop.x0);
        techniques_.tag(path);  // here, because most light paths are never seen
        deliver(*closed, nullptr, 1.0 / double(lightPaths_), iteration, index, pixel, nullptr,
                worker, chunk);
    }
}

void BidirIntegrator::deliver(const Closed& closed, const Proposal* proposal, double scale,
                              std::uint32_t iteration, std::uint64_t sample,
                              std::uint32_t pixelIndex, Rgb* ownPixel, Worker& worker,
                              Chunk& chunk) {
    const double weight = misWeight(worker.path, techniques_, closed.t);
    const Rgb scaled = closed.contribution * float(scale);
    const Rgb value = scene_.lights().inFileUnits(scaled * float(weight));
    if (observer_) {
        observer_({worker.path, closed.t, weight, value, pixelIndex, proposal, techniques_,
                   iteration, sample});
    }
    // Values that are finite may add up to more than a float holds.
    const Rgb sum = ownPixel ? *ownPixel + value : value;
    if (!isFinite(sum)) {
        ++chunk.invalidSamples;
        if (chunk.invalidReplays.size() < kReplaysKept) {
            const int width = camera_.film().width;
            chunk.invalidReplays.push_back(
                closed.t == 1 ? lightReplay(sample, iteration)
                              : std::to_string(sample % std::uint64_t(width)) + "," +
                                    std::to_string(sample / std::uint64_t(width)) + "," +
                                    std::to_string(iteration));
        }
        return;
    }
    const int s = worker.path.edges + 1 - closed.t;
    const Rgb unweighted = techniqueFilm_ ? scene_.lights().inFileUnits(scaled) : Rgb{};
    if (ownPixel) {
        *ownPixel = sum;
        if (techniqueFilm_) techniqueFilm_->add(s, closed.t, pixelIndex, value, unweighted);
    } else {
        chunk.splats.push_back({pixelIndex, value});
        chunk.splatPaths.push_back(sample);
        if (techniqueFilm_) {
            chunk.techniqueSplats.push_back({s, {pixelIndex, value}, unweighted});
        }
    }
}

void BidirIntegrator::collect(std::vector<Chunk>& chunks, std::uint32_t iteration,
                              IterationStatistics& statistics) {
    std::vector<std::vector<Splat>> splats;
    for (Chunk& chunk : chunks) {
        statistics.add(chunk.tally);
        statistics.invalidSamples += chunk.invalidSamples;
        for (std::string& r : chunk.invalidReplays) {
            if (statistics.invalidReplays.size() < kReplaysKept) {
                statistics.invalidReplays.push_back(std::move(r));
            }
        }
        for (const TechniqueSplat& t : chunk.techniqueSplats) {
            techniqueFilm_->add(t.s, 1, t.weighted.pixel, t.weighted.value, t.unweighted);
        }
        recorded_.insert(recorded_.end(), chunk.rays.begin(), chunk.rays.end());
        splats.push_back(std::move(chunk.splats));
    }
    if (pixels_.empty()) return;
    const std::uint64_t leftOut = addSplats(splats, pixels_, threads_);
    statistics.invalidSamples += leftOut;
    // Those to name are part of a sum that is too large: they do not fit on top of what there is.
    for (std::size_t c = 0; leftOut > 0 && c < chunks.size(); ++c) {
        for (std::size_t i = 0; i < splats[c].size(); ++i) {
            if (statistics.invalidReplays.size() == kReplaysKept) return;
            if (isFinite(pixels_[splats[c][i].pixel] + splats[c][i].value)) continue;
            statistics.invalidReplays.push_back(lightReplay(chunks[c].splatPaths[i], iteration));
        }
    }
}

BidirIntegrator::Replayed BidirIntegrator::replayEyePath(std::uint32_t iteration, int x, int y,
                                                         const PathObserver& observer) {
    const std::atomic<bool> never{false};
    IterationStatistics ignored;
    techniques_ = freeze(iteration);
    pixels_ = {};
    if (method_.pool().subpaths > 0) {
        lightPass(iteration, StreamKind::LightPath, false, never, ignored);
    }
    IterationContext context = this->context(ignored);
    method_.prepare(pool_, context);
    Chunk chunk;
    Rgb pixel;
    const PathObserver before = std::exchange(observer_, observer);
    pixelRow(iteration, x, y, *workers_[0], chunk, {&pixel, 1});
    observer_ = before;
    return {workers_[0]->eye[0], techniqueSet_.ownLightPath ? workers_[0]->light[0] : Subpath{}};
}

BidirIntegrator::Replayed BidirIntegrator::replayLightPath(std::uint32_t iteration,
                                                           std::uint64_t index,
                                                           const PathObserver& observer) {
    techniques_ = freeze(iteration);
    Chunk chunk;
    Rng rng(settings_.seed, iteration, StreamKind::LightPath, index);
    Worker& worker = *workers_[0];
    std::vector<PathVertex>& path = worker.light[0];
    walker_.traceLight(rng, chunk.tally, path);
    const PathObserver before = std::exchange(observer_, observer);
    splatLightPath(path, iteration, index, rng, worker, chunk);
    observer_ = before;
    return {{}, path};
}

std::vector<RecordedRay> BidirIntegrator::takeRecording() {
    return std::exchange(recorded_, {});
}

}  // namespace lacuna
