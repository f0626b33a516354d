#include "preprocess/subspace_asset.h"

#include <algorithm>

#include "preprocess/emission_asset.h"
#include "preprocess/number_layer.h"
#include "preprocess/train.h"
#include "preprocess/train_command.h"
#include "preprocess/walk_asset.h"

namespace lacuna {
namespace {

class SubspaceAsset final : public Asset {
  public:
    explicit SubspaceAsset(SubspaceFile file)
        : subspaces_(std::make_shared<const Subspaces>(std::move(file.subspaces))),
          contentHash_(std::move(file.contentHash)) {}

    void giveTo(AssetSet& assets) const override { assets.put(subspaces_); }
    std::string contentHash() const override { return contentHash_; }
    /// Layer `subspace`: the eye subspace for the camera's view [Su22 fig 7]. Layer
    /// `lightSubspace`: the light subspace that Gamma picks most often there.
    void draw(LayeredImage& image, const Scene& scene, const Camera& camera, const PixelRect& crop,
              const ThreadPool& pool) const override {
        const auto eyeSubspace = [&](const SurfacePoint& hit) {
            return subspaces_->eyeTree(subpathEnd(hit.position, hit.ng, camera.position(), false));
        };
        image.setRgb("subspace", numberLayer(scene, camera, crop, pool,
                                             [&](const SurfacePoint& hit, const Vec3&) {
                                                 return std::optional(eyeSubspace(hit));
                                             }));
        image.setRgb(
            "lightSubspace",
            numberLayer(scene, camera, crop, pool, [&](const SurfacePoint& hit, const Vec3&) {
                const auto column = subspaces_->column(eyeSubspace(hit));
                return std::optional(
                    std::uint32_t(std::max_element(column.begin(), column.end()) - column.begin()));
            }));
    }

  private:
    std::shared_ptr<const Subspaces> subspaces_;
    std::string contentHash_;
};

}  // namespace

std::unique_ptr<Asset> acquireSubspaces(const AssetRequest& r) {
    const TrainSettings settings{trainingOptions().read(r.settings, r.prefix)};
    const auto guide = r.before.get<EmissionGuide>();
    const auto walks = r.before.get<WalkGuide>();
    const CacheStamp stamp = subspaceStamp(sceneInputs(r.stage), r.stage.viewInputs, settings,
                                           guide ? guide->contentHash() : kPlainEmission,
                                           walks ? walks->contentHash() : kPlainWalks);
    return std::make_unique<SubspaceAsset>(readOrMake<SubspaceFile>(
        r, stamp, "subspaces", trainRemedy(r), readSubspaceFile, writeSubspaceFile, [&] {
            TrainingView view =
                trainingView(*r.stage.camera, r.stage.aspect, r.stage.limits, settings.paths);
            view.guides = guidesOf(*r.stage.scene, r.before);
            return train(*r.stage.scene, view, settings, stamp, r.pool, r.cancel, r.phases).file;
        }));
}

}  // namespace lacuna
