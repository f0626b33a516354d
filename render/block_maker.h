// Makes iterations with the integrator and the method of the open block.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libcore/bidir/coverage_film.h"
#include "libcore/bidir/integrator.h"
#include "libcore/bidir/layer_film.h"
#include "libcore/bidir/technique_film.h"
#include "libcore/bidir/verify.h"
#include "libcore/methods/registry.h"
#include "render/caches.h"
#include "render/options.h"
#include "render/proposal_layers.h"
#include "render/stage.h"

namespace lacuna {

/// Time and statistics of iterations, with their blocks' warm-ups.
struct Totals {
    double seconds = 0.0;
    IterationStatistics statistics;

    void add(const Totals& other) {
        seconds += other.seconds;
        statistics.add(other.statistics);
    }
};

class BlockMaker {
  public:
    /// The arguments passed by reference must outlive the maker. Sets the size of blocks in
    /// `stage`.
    BlockMaker(const RenderOptions& options, const MethodRow& row, const Settings& settings,
               Stage& stage, const Caches& caches, const ThreadPool& pool);
    BlockMaker(const BlockMaker&) = delete;
    BlockMaker& operator=(const BlockMaker&) = delete;

    const BlockPlan& plan() const { return plan_; }
    /// Whether the iterations of a block must be made in order from the first one, and all in one
    /// process: because the method learns from them, or because layers accumulate them.
    bool blocksAreWhole() const { return learns_ || !layers_.empty(); }
    int warmupIterations() const { return warmupIterations_; }
    /// L: light subpaths per iteration.
    std::uint64_t lightPaths() const { return integrator_->lightPaths(); }
    /// Layers of the open block.
    std::span<BlockLayers* const> layers() const { return layers_; }
    std::optional<WeightVerifier::Result> verified() const;

    /// Opens the block of `iteration`, the next one to be rendered, with a new method that is
    /// warmed up. If the block is continued in the middle, `totals` does not count its warm-up
    /// again. False if cancelled; then the block is not open.
    bool beginBlock(std::uint64_t iteration, const std::atomic<bool>& cancel, Totals& totals);
    /// Renders an iteration of the open block into `pixels`, one per pixel of the crop. If
    /// blocksAreWhole(), iterations must come in order. False if cancelled; then `pixels` are
    /// unfinished, and layers, if any, contain parts of the iteration that cannot be removed.
    bool render(std::uint64_t iteration, std::span<Rgb> pixels, const std::atomic<bool>& cancel,
                Totals& totals);

  private:
    std::unique_ptr<Method> freshMethod() const;

    const MethodRow& row_;
    const Settings& settings_;
    const AssetSet assets_;
    std::unique_ptr<Method> method_;  ///< method of the open block
    // Properties of all methods of the render. Other threads read them while a block is opened.
    const bool learns_;
    const int warmupIterations_;
    BlockPlan plan_;
    std::unique_ptr<BidirIntegrator> integrator_;
    std::unique_ptr<TechniqueFilm> techniques_;
    std::unique_ptr<LayerFilm> layersOfPaths_;
    std::unique_ptr<CoverageFilm> coverage_;
    std::unique_ptr<ProposalLayers> proposals_;
    std::unique_ptr<WeightVerifier> verifier_;
    std::vector<BlockLayers*> layers_;
};

}  // namespace lacuna
