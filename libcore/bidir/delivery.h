// From a closed path to the film: its weight, what observers see, and the pixel or the list of
// splats that it is added to.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libcore/bidir/close.h"
#include "libcore/bidir/layer_film.h"
#include "libcore/bidir/render_setup.h"
#include "libcore/bidir/task.h"
#include "libcore/bidir/technique_film.h"

namespace lacuna {

/// One weighted path, as observers see it: tests, --verify, --replay.
struct PathEvent {
    FullPath& path;
    Technique technique;
    double weight;             ///< MIS
    Rgb contribution;          ///< as it enters the pixel: weights, 1/L, the lights' unit included
    std::uint32_t pixel;       ///< row-major in the crop
    const Proposal* proposal;  ///< connections only
    const TechniqueCounts& counts;
    Sample sample;
};
/// Called from many threads at once; for values that are not finite too.
using PathObserver = std::function<void(const PathEvent&)>;

/// A closed path on its way to a pixel.
struct Contribution {
    const Closed& closed;
    FullPath& path;
    Sample sample;
    std::uint32_t pixel;  ///< row-major in the crop
    double scale = 1.0;   ///< the proposal's weight; 1/L; merges: the kernel / n_m
    const Proposal* proposal = nullptr;
};

class Delivery {
  public:
    explicit Delivery(const RenderSetup& setup) : setup_(setup) {}

    /// Per-technique layers to fill as well, or null.
    void setTechniqueFilm(TechniqueFilm* film) { techniqueFilm_ = film; }
    /// Layers of paths to fill as well, or null.
    void setLayerFilm(LayerFilm* film) { layerFilm_ = film; }
    /// Returns the previous observer.
    PathObserver setObserver(PathObserver observer);
    /// Records every ray of the following tasks in the order in which a task traces them.
    void setRecording(bool on) { recording_ = on; }
    std::vector<RecordedRay> takeRecording() { return std::exchange(recorded_, {}); }

    /// Adds an eye path's contribution to its pixel, which no other task adds to, and returns what it added. With a
    /// null `pixel` it adds nothing and returns what it would have added.
    Rgb toOwnPixel(const Contribution& c, const TechniqueCounts& counts, Rgb* pixel,
                   TaskResult& result) const;
    /// Appends a light subpath's contribution to the task's splats.
    void toSplats(const Contribution& c, const TechniqueCounts& counts, TaskResult& result) const;

    /// Prepares a task's result before the task begins.
    void begin(TaskResult& result) const {
        if (recording_) result.tally.recording = &result.rays;
        if (techniqueFilm_) result.clock.switchOn();
    }
    /// Collects what the tasks counted and recorded.
    void collect(std::span<TaskResult> results, IterationStatistics& statistics);
    /// Adds the tasks' splats to the iteration's picture.
    void addSplats(std::span<TaskResult> results, const Iteration& iteration) const;
    void countIteration() const {
        if (techniqueFilm_) techniqueFilm_->countIteration();
        if (layerFilm_) layerFilm_->countIteration(setup_.threads);
    }

  private:
    /// The contribution with and without its weight, in the file's units.
    struct Weighed {
        double weight;
        Rgb value, unweighted;
    };
    Weighed weigh(const Contribution& c, const TechniqueCounts& counts, RayTally& tally) const;
    void observe(const Contribution& c, const TechniqueCounts& counts, const Weighed& w) const;
    /// The layers' shares of `value`, which the path adds to the picture. There must
    /// be a layer film.
    std::span<const PathLayers::Share> sharesOf(const FullPath& path, const Rgb& value,
                                                TaskResult& result) const {
        return layerFilm_->layers().shares(path, value, result.layerScratch);
    }
    void countInvalid(const Sample& sample, TaskResult& result) const;
    /// Whether the path is the environment seen directly, and the background is transparent.
    bool isBackground(const FullPath& path) const {
        return setup_.settings.transparentBackground && path.edges == 1 &&
               path.vertex[0]->infinite();
    }

    const RenderSetup& setup_;
    TechniqueFilm* techniqueFilm_ = nullptr;
    LayerFilm* layerFilm_ = nullptr;
    PathObserver observer_;
    bool recording_ = false;
    std::vector<RecordedRay> recorded_;
};

}  // namespace lacuna
