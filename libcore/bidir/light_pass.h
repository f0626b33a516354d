// The light subpaths of an iteration: some go into the pool that eye vertices pick from, some splat
// to the lens.
#pragma once

#include <span>

#include "libcore/bidir/delivery.h"
#include "libcore/bidir/pool.h"

namespace lacuna {

class LightPass {
  public:
    /// All arguments must outlive the pass.
    LightPass(const RenderSetup& setup, Delivery& delivery, const Workers& workers)
        : setup_(setup), delivery_(delivery), workers_(workers) {}

    /// The purpose for which light subpaths are traced.
    struct Purpose {
        StreamKind stream;
        std::uint64_t pooled;  ///< subpaths [0, pooled) go into the pool
        std::uint64_t splats;  ///< subpaths [0, splats) are shown to the lens
    };

    /// Replaces the pool, and splats into the iteration's pixels. Leaves out the subpaths that pixels trace for
    /// themselves; pooled ones the pixels take from the pool. False if cancelled.
    bool run(const Iteration& iteration, const Purpose& purpose, LightPool& pool);

    /// Traces subpaths into worker.light, at most kTile of them, labels them where they are kept,
    /// and uses each for its purpose.
    void trace(std::span<const std::uint64_t> numbers, const Iteration& iteration,
               const Purpose& purpose, Worker& worker, TaskResult& result) const;

  private:
    bool tracedByItsPixel(std::uint64_t number, const Purpose& purpose) const;
    void label(std::span<PathVertex> path, const Iteration& iteration, TaskResult& result) const;
    void splat(std::span<PathVertex> path, bool labelled, std::uint64_t number, Rng& rng,
               const Iteration& iteration, Worker& worker, TaskResult& result) const;

    const RenderSetup& setup_;
    Delivery& delivery_;
    const Workers& workers_;
    /// By task of a batch: memory for vertices. It is kept, because new memory costs more than tracing.
    std::vector<std::vector<PathVertex>> memory_;
};

}  // namespace lacuna
