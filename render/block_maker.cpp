#include "render/block_maker.h"

#include "libcore/base/stopwatch.h"
#include "preprocess/emission_asset.h"
#include "render/block_plan.h"

namespace lacuna {

BlockMaker::BlockMaker(const RenderOptions& options, const MethodRow& row, const Settings& settings,
                       Stage& stage, const Caches& caches, const ThreadPool& pool)
    : row_(row),
      settings_(settings),
      assets_(caches.all()),
      method_(freshMethod()),
      learns_(method_->learns()),
      warmupIterations_(method_->warmupIterations()),
      plan_(planOf(options, *method_)) {
    stage.settings.blockIterations = plan_.iterations;
    stage.settings.guides = guidesOf(*stage.scene, assets_);
    integrator_ = std::make_unique<BidirIntegrator>(*stage.scene, *stage.camera, stage.techniques,
                                                    *method_, stage.settings, pool);
    const PixelRect& crop = stage.settings.crop;
    if (options.techniques) {
        techniques_ = std::make_unique<TechniqueFilm>(
            crop.width(), crop.height(), stage.settings.limits.maxDepth, plan_.sampleIterations(),
            method_->merging().where != Merges::Nowhere);
        integrator_->delivery().setTechniqueFilm(techniques_.get());
        layers_.push_back(techniques_.get());
    }
    if (!stage.layers.empty()) {
        layersOfPaths_ =
            std::make_unique<LayerFilm>(stage.layers, crop.width(), crop.height(),
                                        options.lightNoise ? plan_.sampleIterations() : 0);
        integrator_->delivery().setLayerFilm(layersOfPaths_.get());
        layers_.push_back(layersOfPaths_.get());
    }
    if (stage.settings.transparentBackground) {
        coverage_ = std::make_unique<CoverageFilm>(crop.width(), crop.height());
        integrator_->setCoverageFilm(coverage_.get());
        layers_.push_back(coverage_.get());
    }
    if (options.verify) {
        verifier_ = std::make_unique<WeightVerifier>(integrator_->walker(), pool);
    }
    if (options.techniques && !row.proposalLabels.empty()) {
        proposals_ =
            std::make_unique<ProposalLayers>(row.proposalLabels, crop.width(), crop.height());
        layers_.push_back(proposals_.get());
    }
    if (verifier_ || proposals_) {
        integrator_->delivery().setObserver([this](const PathEvent& event) {
            if (verifier_) verifier_->check(event);
            if (proposals_) proposals_->add(event);
        });
    }
}

std::unique_ptr<Method> BlockMaker::freshMethod() const {
    std::unique_ptr<Method> method = row_.create(settings_);
    method->use(assets_);
    return method;
}

std::optional<WeightVerifier::Result> BlockMaker::verified() const {
    if (!verifier_) return std::nullopt;
    return verifier_->result();
}

bool BlockMaker::beginBlock(std::uint64_t iteration, const std::atomic<bool>& cancel,
                            Totals& totals) {
    std::unique_ptr<Method> fresh = freshMethod();
    Totals ofWarmUp;
    bool complete = false;
    {
        const Stopwatch watch(ofWarmUp.seconds);
        complete = integrator_->beginBlock(iteration / plan_.iterations, *fresh, cancel,
                                           ofWarmUp.statistics);
    }
    method_ = std::move(fresh);
    if (complete && iteration % plan_.iterations == 0) totals.add(ofWarmUp);
    return complete;
}

bool BlockMaker::render(std::uint64_t iteration, std::span<Rgb> pixels,
                        const std::atomic<bool>& cancel, Totals& totals) {
    const Stopwatch watch(totals.seconds);
    if (!integrator_->render(std::uint32_t(iteration), pixels, cancel, totals.statistics)) {
        return false;
    }
    if (proposals_) proposals_->countIteration();
    return true;
}

}  // namespace lacuna
