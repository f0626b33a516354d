#include "render/choose/trial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "preprocess/emission_asset.h"
#include "render/choose/processor_share.h"

namespace lacuna {
namespace {

/// Cost of an iteration of the whole picture, from one of the small picture. The whole picture has
/// `paths` times as many light subpaths (1 for a pool, more for splats) and `pixels` times as many
/// pixels.
double ofWholePicture(double lightPart, double rest, double paths, double pixels) {
    return lightPart * paths + rest * pixels;
}

/// Estimates the undisturbed time of a phase of an iteration. Cold caches slow down early
/// iterations, and other programs slow down most.
class QuietSeconds {
  public:
    explicit QuietSeconds(const char* phase) : phase_(phase) {}
    void see(IterationStatistics& one) { least_ = std::min(least_, one.phaseSeconds[phase_]); }
    /// The smaller of the quickest iteration and the mean without waiting. `all` is the sum over
    /// the `count` iterations seen; they got `share` of the processor time that they wanted.
    double value(IterationStatistics& all, double count, double share) const {
        return std::min(least_, share * all.phaseSeconds[phase_] / count);
    }

  private:
    const char* phase_;
    double least_ = std::numeric_limits<double>::infinity();
};

/// Whether only merges can make the path.
bool isOnlyMerged(const PathEvent& event) {
    if (!event.technique.merges() || SpecularChains::reach(event.path)) return false;
    for (int t = 1; t <= event.path.edges + 1; ++t) {
        if (effectiveCount(event.path, event.counts, t) > 0.0) return false;
    }
    return true;
}

}  // namespace

Image enlarged(const SmallFilm& small, const HalfPictures& halves, const PixelRect& crop) {
    Image image(crop.width(), crop.height());
    const auto from = [](int at, int size, int smallSize) {
        return std::size_t(std::int64_t(at) * smallSize / size);
    };
    for (int y = 0; y < image.height; ++y) {
        const std::size_t row = from(y, image.height, small.crop.height());
        for (int x = 0; x < image.width; ++x) {
            const std::size_t i =
                row * std::size_t(small.crop.width()) + from(x, image.width, small.crop.width());
            image.at(x, y) = (halves.first[i] + halves.second[i]) * 0.5f;
        }
    }
    return image;
}

bool runTrial(const Stage& stage, const SmallFilm& small, const MethodRow& row,
              const Settings& settings, const Caches& caches, double poolScale, Sampling sampling,
              std::uint64_t seed, double rays, const ThreadPool& pool,
              const std::atomic<bool>& cancel, Trial& result) {
    const std::unique_ptr<Method> method = row.create(settings);
    const AssetSet assets = caches.all();
    method->use(assets);
    RenderSettings render = stage.settings;
    render.guides = guidesOf(*stage.scene, assets);
    render.crop = small.crop;
    const double filmPixels = pixelsOf(stage.camera->film()), smallPixels = pixelsOf(small.film);
    const auto splats = double(lightPathsOf(settings));  // 0: as many as pixels
    render.lightPaths = std::uint64_t(std::ceil(splats * smallPixels / filmPixels));
    render.sampling = sampling;
    const Camera camera = stage.camera->withFilm(small.film);
    // A technique that is forced off is off for all rows.
    Techniques techniques = row.techniques;
    techniques.hits &= stage.techniques.hits;
    techniques.connects &= stage.techniques.connects;
    techniques.splats &= stage.techniques.splats;
    techniques.chains &= stage.techniques.chains;
    techniques.refractions &= stage.techniques.refractions;
    techniques.knownWays &= stage.techniques.knownWays;
    // Separate integrators with different seeds keep the halves independent even with even numbers.
    std::vector<std::unique_ptr<BidirIntegrator>> integrators;
    for (const std::uint64_t ofHalf : {seed, ~seed}) {
        render.seed = ofHalf;
        integrators.push_back(std::make_unique<BidirIntegrator>(*stage.scene, camera, techniques,
                                                                *method, render, pool));
    }

    IterationStatistics warmUp, statistics;
    if (!integrators.front()->beginBlock(0, *method, cancel, warmUp)) return false;
    const auto pixels = std::size_t(small.crop.width()) * std::size_t(small.crop.height());
    std::vector<Rgb> picture(pixels);
    std::vector<Rgb>* const halves[] = {&result.halves.first, &result.halves.second};
    for (auto* half : halves) half->assign(pixels, Rgb{});
    if (method->merging().where != Merges::Nowhere) {
        result.onlyMerged.assign(pixels, Rgb{});
        // No data race: a merge belongs to its own pixel's task.
        for (const auto& integrator : integrators) {
            integrator->delivery().setObserver([&](const PathEvent& event) {
                if (isOnlyMerged(event) && isFinite(event.contribution)) {
                    result.onlyMerged[event.pixel] += event.contribution;
                }
            });
        }
    }
    QuietSeconds light("light paths"), prepare("prepare"), eye("eye paths"), observe("observe");
    const ProcessorShare processors;
    std::uint64_t& n = result.iterations;
    for (n = 0; n < 2 || n % 2 == 1 || double(statistics.totalRays()) < rays; ++n) {
        IterationStatistics one;
        if (!integrators[n % 2]->render(std::uint32_t(n / 2), picture, cancel, one)) return false;
        for (QuietSeconds* phase : {&light, &prepare, &eye, &observe}) phase->see(one);
        statistics.add(one);
        for (std::size_t i = 0; i < pixels; ++i) (*halves[n % 2])[i] += picture[i];
    }
    const double share = processors.value();
    const float ofHalf = 2.0f / float(n);
    for (auto* sums : halves) {
        for (Rgb& c : *sums) c = c * ofHalf;
    }

    for (Rgb& c : result.onlyMerged) c = c * (0.5f * ofHalf);

    // Pixels that trace their own light subpaths do so in the eye pass.
    const double own = row.techniques.ownLightPath ? double(pixels) : 0.0;
    const auto pooled = double(method->pool().subpaths);
    const auto pathsOf = [&](double splatted, double pixelsOwn) {
        return std::max({pooled, row.techniques.splats ? splatted : 0.0, pixelsOwn, 1.0});
    };
    const double few = pathsOf(splats > 0.0 ? double(render.lightPaths) : smallPixels, own);
    const double all = pathsOf(splats > 0.0 ? splats : filmPixels, own * small.scale);
    const auto count = double(n);
    const auto lightRays = double(statistics.rays[std::size_t(RayKind::LightWalk)]) +
                           double(statistics.rays[std::size_t(RayKind::Splat)]);
    const auto allRays = double(statistics.totalRays());
    result.rays = ofWholePicture(lightRays, allRays - lightRays, all / few, small.scale) / count;
    const double apart = std::max(1.0, few - own), allApart = all - own * small.scale;
    const auto quiet = [&](const QuietSeconds& phase) {
        return phase.value(statistics, count, share);
    };
    result.seconds = ofWholePicture(quiet(light), quiet(eye), allApart / apart, small.scale) +
                     (quiet(prepare) + quiet(observe)) * poolScale;
    return true;
}

}  // namespace lacuna
