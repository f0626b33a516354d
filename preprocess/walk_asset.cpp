#include "preprocess/walk_asset.h"

#include <algorithm>

#include "libcore/guide/walk_settings.h"
#include "preprocess/emission_asset.h"
#include "preprocess/train_command.h"

namespace lacuna {
namespace {

class WalkAsset final : public Asset {
  public:
    explicit WalkAsset(WalkFile file) : file_(std::move(file)) {}

    void giveTo(AssetSet& assets) const override {
        if (file_.guide) assets.put(file_.guide);
    }
    std::string contentHash() const override { return file_.contentHash; }
    /// Layer `walks`: the probabilities that eye walks (red) and light walks (green) follow the guide at the visible
    /// point of each pixel.
    void draw(LayeredImage& image, const Scene& scene, const Camera& camera, const PixelRect& crop,
              const ThreadPool& pool) const override {
        Image layer(crop.width(), crop.height());
        if (file_.guide) {
            const WalkGuide& guide = *file_.guide;
            const Walker walker(scene, {nullptr, file_.guide}, camera, {});
            pool.forEach(std::size_t(crop.height()), [&](std::size_t row) {
                RayTally tally;
                std::vector<PathVertex> path;
                for (int x = crop.x0; x < crop.x1; ++x) {
                    Rng rng(1, 0, StreamKind::User, std::uint64_t(x));
                    walker.traceEye({float(x) + 0.5f, float(crop.y0 + int(row)) + 0.5f}, rng, tally,
                                    path);
                    const auto seen =
                        std::find_if(path.begin(), path.end(),
                                     [](const PathVertex& v) { return v.region != kNone; });
                    if (seen == path.end()) continue;
                    const WalkGuide::Region& r = guide.region(seen->region);
                    layer.at(x - crop.x0, int(row)) =
                        Rgb(r.of(Side::Eye).share, r.of(Side::Light).share, 0.0f);
                }
            });
        }
        image.setRgb("walks", layer);
    }

  private:
    WalkFile file_;
};

}  // namespace

std::unique_ptr<Asset> acquireWalks(const AssetRequest& r) {
    const WalkSettings settings = walkOptions({}).read(r.settings, r.prefix);
    const std::uint64_t paths = guidePaths(settings.paths, trainingPaths(r.settings));
    const auto emission = r.before.get<EmissionGuide>();
    const CacheStamp stamp =
        walkStamp(sceneInputs(r.stage), r.stage.viewInputs, paths, r.techniques,
                  emission ? emission->contentHash() : kPlainEmission);
    return std::make_unique<WalkAsset>(
        readOrMake<WalkFile>(r, stamp, "walks", trainRemedy(r), readWalkFile, writeWalkFile, [&] {
            WalkFile file;
            r.phases.run("walks", [&] {
                file = walkFile(
                    stamp,
                    trainWalks(*r.stage.scene, *r.stage.camera, r.stage.aspect, r.stage.limits,
                               guidesOf(*r.stage.scene, r.before).lights, r.techniques, paths,
                               r.options.common.seed, r.pool, r.cancel));
            });
            return file;
        }));
}

WalkFile walkFile(const CacheStamp& stamp, const WalkTraining& training) {
    const auto& guide = training.learned.guide;
    return {guide, stamp, guide ? guide->contentHash() : kPlainWalks};
}

}  // namespace lacuna
