// The eye subpaths of an iteration, one per pixel: hits, picks, connections, merges, chains.
#pragma once

#include "libcore/bidir/known_ways.h"
#include "libcore/bidir/light_pass.h"
#include "libcore/bidir/photon_grid.h"
#include "libcore/bidir/refracted_lamps.h"
#include "libcore/bidir/specular_chains.h"

namespace lacuna {

class EyePass {
  public:
    /// All arguments must outlive the pass. `photons` are vertices of `pool`, and empty where nothing is merged.
    /// `chains` may be null.
    EyePass(const RenderSetup& setup, const LightPass& lightPass, const LightPool& pool,
            const PhotonGrid& photons, const SpecularChains* chains, Delivery& delivery,
            const Workers& workers)
        : setup_(setup),
          lightPass_(lightPass),
          pool_(pool),
          photons_(photons),
          chains_(chains),
          delivery_(delivery),
          workers_(workers) {}

    /// Renders all pixels of the crop. False if cancelled.
    bool run(const Iteration& iteration) const;
    /// Renders one pixel of the film into `value`; pixels that share its walk are traced along.
    /// Returns the index of its subpaths in worker.eye and worker.light.
    std::size_t pixel(const Iteration& iteration, int x, int y, Rgb& value, Worker& worker,
                      TaskResult& result) const;

  private:
    /// The pixels that receive light, and their values.
    struct Target {
        PixelRect shown;
        Rgb* values;  ///< row-major in `shown`

        Rgb* at(int x, int y) const {
            return shown.contains(x, y)
                       ? values + std::ptrdiff_t(y - shown.y0) * shown.width() + (x - shown.x0)
                       : nullptr;
        }
    };
    using Joints = Worker::Joints;
    /// Range of eye subpaths z_0 .. z_{t-1}: t from first to last, both included.
    struct Ends {
        std::size_t first, last;
    };
    /// Grid of blocks of pixels whose walks are traced together. (x0, y0) is the corner of
    /// the first one.
    struct Blocks {
        int x0, y0, width, height;
        PixelRect bounds;  ///< pixels outside are in no block

        PixelRect at(int x, int y) const;
    };

    Blocks blocksOf(const Iteration& iteration) const;
    void block(const Iteration& iteration, const PixelRect& pixels, const Target& target,
               Worker& worker, TaskResult& result) const;
    void closeAlone(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                    TaskResult& result) const;
    void closeTogether(std::span<const PixelPaths> all, const Iteration& iteration, Worker& worker,
                       TaskResult& result) const;
    void closeGroup(std::span<const PixelPaths> group, std::span<const Joints> joints,
                    const Iteration& iteration, Worker& worker, TaskResult& result) const;
    std::size_t lend(std::size_t lender, std::size_t h, std::span<const PixelPaths> group,
                     const Joints& joints, const Iteration& iteration, Worker& worker,
                     TaskResult& result) const;
    void borrow(std::size_t borrower, const PixelPaths& paths, const Iteration& iteration,
                Worker& worker, TaskResult& result) const;
    /// Calls f(ending) for each hit and each connection of the eye path, in the order of t. Calls after(t) when those
    /// of t are done.
    template <class F, class After>
    void forEachEnding(const PixelPaths& paths, const Joints& joints, Ends ends, const F& f,
                       const After& after) const {
        std::size_t next = 0;
        for (std::size_t t = ends.first; t <= ends.last; ++t) {
            if (setup_.techniques.hits && paths.eye[t - 1].light != kNone) {
                f(Ending{t, nullptr, nullptr});
            }
            while (next < joints.open.size() && joints.open[next].eye.size() < t) ++next;
            for (; next < joints.open.size() && joints.open[next].eye.size() == t; ++next) {
                f(Ending{t, &joints.open[next], joints.openedBy[next]});
            }
            after(t);
        }
    }
    void close(const PixelPaths& paths, const Joints& joints, Ends ends, const Iteration& iteration,
               Worker& worker, TaskResult& result) const;
    void searchBehindGlass(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                           TaskResult& result) const;
    /// Closes the path that ends with `ending`. Returns what the pixel got, or would get if
    /// it is not shown.
    Rgb closeAt(const Ending& ending, Subpath eye, const PixelPaths& paths,
                const Iteration& iteration, Worker& worker, TaskResult& result,
                double scale = 1.0) const;
    /// Adds the path that was closed last to its own pixel.
    Rgb deliver(const Closed& closed, const PixelPaths& paths, const Iteration& iteration,
                Worker& worker, TaskResult& result, double scale = 1.0,
                const Proposal* proposal = nullptr) const {
        return delivery_.toOwnPixel(
            {closed, worker.fullPath, paths.sample, paths.pixel, scale, proposal}, iteration.counts,
            paths.value, result);
    }
    void merge(const PixelPaths& paths, Subpath eye, const Iteration& iteration, Worker& worker,
               TaskResult& result) const;
    void chain(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
               TaskResult& result) const;
    void refract(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                 TaskResult& result) const;
    void goKnownWays(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                     TaskResult& result) const;
    void select(const PixelPaths& paths, Joints& joints, const Iteration& iteration,
                TaskResult& result) const;
    void open(const PixelPaths& paths, Joints& joints, const Iteration& iteration,
              TaskResult& result) const;

    const RenderSetup& setup_;
    const LightPass& lightPass_;
    const LightPool& pool_;
    const PhotonGrid& photons_;
    const SpecularChains* chains_;
    Delivery& delivery_;
    const Workers& workers_;
};

}  // namespace lacuna
