#include "preprocess/emission_asset.h"

#include <vector>

#include "libcore/base/error.h"
#include "libcore/guide/emission_settings.h"
#include "preprocess/train_command.h"

namespace lacuna {
namespace {

class EmissionAsset final : public Asset {
  public:
    explicit EmissionAsset(EmissionFile file) : file_(std::move(file)) {}

    void giveTo(AssetSet& assets) const override {
        if (file_.guide) assets.put(file_.guide);
    }
    std::string contentHash() const override { return file_.contentHash; }
    /// Layer `emission`: the density of light rays towards the visible point of each pixel,
    /// relative to that without a guide; a mean over some points of the lights.
    void draw(LayeredImage& image, const Scene& scene, const Camera& camera, const PixelRect& crop,
              const ThreadPool& pool) const override {
        Image layer(crop.width(), crop.height());
        std::vector<LightPoint> points;
        if (file_.guide && !scene.lights().empty()) {
            constexpr std::uint32_t kPoints = 32;
            for (std::uint32_t i = 0; i < kPoints; ++i) {
                Rng rng(1, 0, StreamKind::User, i);
                points.push_back(scene.lights().samplePoint(rng));
            }
        }
        const auto guided =
            points.empty() ? nullptr
                           : std::make_shared<const Lights>(scene.lights().guidedBy(file_.guide));
        pool.forEach(std::size_t(crop.height()), [&](std::size_t row) {
            RayTally tally;
            for (int x = crop.x0; x < crop.x1; ++x) {
                const Vec2 raster{float(x) + 0.5f, float(crop.y0 + int(row)) + 0.5f};
                const Vec3 direction = camera.directionAt(camera.position(), raster).direction;
                const auto hit =
                    scene.intersect(camera.position(), {}, direction, RayKind::Camera, tally);
                if (!hit) continue;
                double sum = points.empty() ? 1.0 : 0.0;
                for (const LightPoint& p : points) {
                    const Vec3 away =
                        isInfinite(p.kind) ? -p.position : normalize(hit->position - p.position);
                    const Lights::GuidedPdfs pdfs = guided->guidedPdfs(p, away, hit->position);
                    sum += double(pdfs.point) * double(pdfs.ray) / double(points.size());
                }
                layer.at(x - crop.x0, int(row)) = Rgb(float(sum));
            }
        });
        image.setRgb("emission", layer);
    }

  private:
    EmissionFile file_;
};

}  // namespace

std::unique_ptr<Asset> acquireEmission(const AssetRequest& r) {
    const EmissionSettings settings = emissionOptions({}).read(r.settings, r.prefix);
    const std::uint64_t paths = guidePaths(settings.paths, trainingPaths(r.settings));
    const CacheStamp stamp = emissionStamp(sceneInputs(r.stage), r.stage.viewInputs, paths);
    const auto read = [&](const std::string& path, const CacheStamp& expected,
                          const std::string& remedy) {
        EmissionFile found = readEmissionFile(path, expected, remedy);
        const std::size_t lights = r.stage.scene->lights().size();
        if (found.guide && found.guide->pmf.size() != lights) {
            throw InputError(path + ": expected " + std::to_string(lights) + " lights, found " +
                             std::to_string(found.guide->pmf.size()) + "; " + remedy);
        }
        return found;
    };
    return std::make_unique<EmissionAsset>(readOrMake<EmissionFile>(
        r, stamp, "emission", trainRemedy(r), read, writeEmissionFile, [&] {
            EmissionFile file;
            r.phases.run("emission", [&] {
                file = emissionFile(stamp, trainEmission(*r.stage.scene, *r.stage.camera,
                                                         r.stage.aspect, r.stage.limits, paths,
                                                         r.options.common.seed, r.pool, r.cancel));
            });
            return file;
        }));
}

EmissionFile emissionFile(const CacheStamp& stamp, const EmissionTraining& training) {
    const auto& guide = training.learned.guide;
    return {guide, stamp, guide ? guide->contentHash() : kPlainEmission};
}

Guides guidesOf(const Scene& scene, const AssetSet& assets) {
    const auto emission = assets.get<EmissionGuide>();
    return {emission ? std::make_shared<const Lights>(scene.lights().guidedBy(emission)) : nullptr,
            assets.get<WalkGuide>()};
}

}  // namespace lacuna
