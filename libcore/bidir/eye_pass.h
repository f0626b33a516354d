// The eye subpaths of an iteration, one per pixel: hits, picks, connections, merges, chains.
#pragma once

#include "libcore/bidir/light_pass.h"
#include "libcore/bidir/photon_grid.h"
#include "libcore/bidir/refracted_lamps.h"
#include "libcore/bidir/specular_chains.h"

namespace lacuna {

class EyePass {
  public:
    /// All must outlive it. `photons` are vertices of `pool`, none where nothing is merged; `chains`
    /// may be null.
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

    /// All pixels of the crop. False if cancelled.
    bool run(const Iteration& iteration) const;
    /// Pixels x0, x0 + 1, .. of row y, at most kTile of them, into `pixels`.
    void pixelRow(const Iteration& iteration, int x0, int y, std::span<Rgb> pixels, Worker& worker,
                  TaskResult& result) const;

  private:
    /// A pixel's subpaths, where they belong, and where their light goes.
    struct PixelPaths {
        Subpath eye, ownLight;
        Sample sample;
        std::uint32_t pixel;  ///< row-major in the crop
        Rgb& value;
    };

    void close(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
               TaskResult& result) const;
    /// The path that was closed last, to its own pixel.
    void deliver(const Closed& closed, const PixelPaths& paths, const Iteration& iteration,
                 Worker& worker, TaskResult& result, double scale = 1.0,
                 const Proposal* proposal = nullptr) const {
        delivery_.toOwnPixel({closed, worker.fullPath, paths.sample, paths.pixel, scale, proposal},
                             iteration.counts, paths.value, result);
    }
    void merge(const PixelPaths& paths, Subpath eye, const Iteration& iteration, Worker& worker,
               TaskResult& result) const;
    void chain(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
               TaskResult& result) const;
    void refract(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                 TaskResult& result) const;
    void select(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
                TaskResult& result) const;
    void open(const PixelPaths& paths, const Iteration& iteration, Worker& worker,
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
