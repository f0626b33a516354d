// Makes iterations: the integrator with the method of the open block.
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

/// What iterations cost and counted, with their blocks' warm-ups.
struct Totals {
    double seconds = 0.0;
    IterationStatistics statistics;

    void add(const Totals& other) {
        seconds += other.seconds;
        statistics.add(other.statistics);
    }
};

/// What must be finished whatever is asked for.
inline const std::atomic<bool> kNeverCancelled{false};

class BlockMaker {
  public:
    /// Those that are passed by reference must outlive the maker. Tells `stage` how large blocks
    /// are.
    BlockMaker(const RenderOptions& options, const MethodRow& row, const Settings& settings,
               Stage& stage, const Caches& caches, const ThreadPool& pool);
    BlockMaker(const BlockMaker&) = delete;
    BlockMaker& operator=(const BlockMaker&) = delete;

    const BlockPlan& plan() const { return plan_; }
    /// Whether a block's iterations can only be made from its first one on, and all in one place:
    /// the method learns from them, or layers hold them together.
    bool blocksAreWhole() const { return learns_ || !layers_.empty(); }
    int warmupIterations() const { return warmupIterations_; }
    /// L.
    std::uint64_t lightPaths() const { return integrator_->lightPaths(); }
    /// Of the open block.
    std::span<BlockLayers* const> layers() const { return layers_; }
    std::optional<WeightVerifier::Result> verified() const;

    /// Opens the block of `iteration`, which is to be rendered next: a method as new, warmed up.
    /// Whoever goes on in the middle of a block does not count its warm-up: that is counted once.
    /// False if cancelled; then the block is not open.
    bool beginBlock(std::uint64_t iteration, const std::atomic<bool>& cancel, Totals& totals);
    /// Renders an iteration of the open block into `pixels`, one per pixel of the crop. Where blocks
    /// are whole, they must come in order. False if cancelled; then `pixels` are not finished,
    /// and layers, if there are some, hold parts of it that cannot be taken out again.
    bool render(std::uint64_t iteration, std::span<Rgb> pixels, const std::atomic<bool>& cancel,
                Totals& totals);

  private:
    std::unique_ptr<Method> freshMethod() const;

    const MethodRow& row_;
    const Settings& settings_;
    const AssetSet assets_;
    std::unique_ptr<Method> method_;  ///< of the open block
    // What all of them say: asked for by other threads while a block is opened.
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
