// The one integrator: light paths -> pool -> eye paths -> connections -> weights -> film. It knows
// no method by name.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libcore/base/parallel.h"
#include "libcore/bidir/connect.h"
#include "libcore/bidir/film.h"
#include "libcore/bidir/method.h"
#include "libcore/bidir/path_space.h"
#include "libcore/bidir/walk.h"

namespace lacuna {

struct RenderSettings {
    WalkLimits limits;
    std::uint64_t seed = 1;
    PixelRect crop;                ///< inside the camera's film
    std::uint64_t lightPaths = 0;  ///< L; 0: one per pixel of the full film
};

/// One weighted path, as observers see it: tests, --verify, --replay.
struct PathEvent {
    FullPath& path;
    int t;
    double weight;             ///< MIS
    Rgb contribution;          ///< as it enters the pixel: weights, 1/L, the lights' unit included
    std::uint32_t pixel;       ///< row-major in the crop
    const Proposal* proposal;  ///< connections only
    const Techniques& techniques;
    std::uint32_t iteration;
    std::uint64_t sample;  ///< t = 1: light subpath; else pixel, row-major in the full film
};
/// Called from many threads at once; for values that are not finite too.
using PathObserver = std::function<void(const PathEvent&)>;

class BidirIntegrator {
  public:
    /// All references must outlive the integrator.
    BidirIntegrator(const Scene& scene, const Camera& camera, TechniqueSet techniques,
                    Method& method, const RenderSettings& settings, const ThreadPool& pool);
    ~BidirIntegrator();

    /// Iterations that the method wants thrown away before the first: call once, first.
    /// Returns false if cancelled.
    bool warmUp(const std::atomic<bool>& cancel, IterationStatistics& statistics);

    /// Renders one iteration, one eye path per pixel of the crop, into `pixels` (overwritten).
    /// Iterations must come in order 0, 1, .. Returns false, leaving `pixels` unfinished, if
    /// cancelled.
    bool render(std::uint32_t iteration, std::span<Rgb> pixels, const std::atomic<bool>& cancel,
                IterationStatistics& statistics);

    /// Runs one sample alone after the light pass of its iteration: eye path through a pixel of the
    /// full film, or one light subpath. Iterations before it must have been run where the method
    /// learns from them. Returns the walks' vertices, valid until the next call of anything.
    struct Replayed {
        Subpath eye, light;
    };
    Replayed replayEyePath(std::uint32_t iteration, int x, int y, const PathObserver& observer);
    Replayed replayLightPath(std::uint32_t iteration, std::uint64_t index,
                             const PathObserver& observer);

    /// Per-technique layers to fill as well, or null.
    void setTechniqueFilm(TechniqueFilm* film) { techniqueFilm_ = film; }
    void setObserver(PathObserver observer) { observer_ = std::move(observer); }
    /// Records every ray of the following iterations in the order in which a chunk traces them.
    void setRecording(bool on) { recording_ = on; }
    std::vector<RecordedRay> takeRecording();

    std::uint64_t lightPaths() const { return lightPaths_; }
    const LightPool& pool() const { return pool_; }

  private:
    struct Chunk;
    struct Worker;

    bool lightPass(std::uint32_t iteration, StreamKind kind, bool splat,
                   const std::atomic<bool>& cancel, IterationStatistics& statistics);
    bool eyePass(std::uint32_t iteration, const std::atomic<bool>& cancel,
                 IterationStatistics& statistics);
    /// Into worker.light, with worker.rngs behind their last draws; at most a tile's width of them.
    void traceLightPaths(std::span<const std::uint64_t> indices, std::uint32_t iteration,
                         StreamKind kind, Worker& worker, Chunk& chunk);
    /// Pixels x0, x0 + 1, .. of row y, at most a tile's width of them.
    void pixelRow(std::uint32_t iteration, int x0, int y, Worker& worker, Chunk& chunk,
                  std::span<Rgb> pixels);
    void closeEyePath(std::uint32_t iteration, Subpath path, Subpath light, int x, int y,
                      Worker& worker, Chunk& chunk, Rgb& pixel);
    void select(std::uint32_t iteration, Subpath path, Subpath light, std::uint32_t filmIndex,
                Worker& worker) const;
    void open(Subpath path, Worker& worker, Chunk& chunk) const;
    void splatLightPath(std::span<PathVertex> path, std::uint32_t iteration, std::uint64_t index,
                        Rng& rng, Worker& worker, Chunk& chunk);
    void deliver(const Closed& closed, const Proposal* proposal, double scale,
                 std::uint32_t iteration, std::uint64_t sample, std::uint32_t pixelIndex,
                 Rgb* ownPixel, Worker& worker, Chunk& chunk);
    void collect(std::vector<Chunk>& chunks, std::uint32_t iteration,
                 IterationStatistics& statistics);
    Techniques freeze(std::uint32_t iteration);
    IterationContext context(IterationStatistics& statistics) const;

    const Scene& scene_;
    const Camera& camera_;
    TechniqueSet techniqueSet_;
    Method& method_;
    RenderSettings settings_;
    const ThreadPool& threads_;
    Walker walker_;
    ScenePaths space_{walker_};
    std::uint64_t lightPaths_;
    Techniques techniques_;
    LightPool pool_;
    std::span<Rgb> pixels_;
    std::vector<std::unique_ptr<Worker>> workers_;
    TechniqueFilm* techniqueFilm_ = nullptr;
    PathObserver observer_;
    bool recording_ = false;
    std::vector<RecordedRay> recorded_;
};

}  // namespace lacuna
