// (theory.md, "Effort behind glass")
#include "libcore/methods/glass_effort.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "libcore/bidir/integrator.h"
#include "libcore/bidir/small_film.h"
#include "libcore/image/smoothed.h"
#include "libcore/methods/registry.h"

namespace lacuna {

namespace {

constexpr double kPixels = 4096;
/// Share of the pixels, the noisiest ones, that do not count as noise of walks: more samples of the technique would
/// take their sparks away.
constexpr double kSparks = 0.01;
/// Time of a ray in search of a chain, Newton's method included, over that of another ray.
constexpr double kChainRay = 3.0;

/// Share of the mean brightness that is added to a pixel's: darkness is no reason for samples.
constexpr double kDark = 0.01;

/// Limits of an effort: samples over those of the pilot.
struct Range {
    double least, most;
};
constexpr Range kOfRefractions{1.0 / 16, 1.0};
/// The limits are narrow because a pilot knows little: it misses most sparks of chains, or a
/// single one decides.
constexpr Range kOfChains{1.0 / 8, 2.0};

double meanOf(std::span<const double> values) {
    return std::reduce(values.begin(), values.end()) / double(values.size());
}

/// The mean over the pixels but for the largest ones, which count as zero.
double meanWithoutSparks(std::vector<double> values) {
    const auto kept = std::size_t(std::ceil((1.0 - kSparks) * double(values.size())));
    std::ranges::nth_element(values, values.begin() + std::ptrdiff_t(kept) - 1);
    return std::reduce(values.begin(), values.begin() + std::ptrdiff_t(kept)) /
           double(values.size());
}

/// A picture of two iterations.
struct PilotPicture {
    int width;
    /// By iteration and pixel: the contributions of one kind of technique, and the rest.
    std::array<std::vector<double>, 2> own, rest;
    double chainRays, otherRays;
};

PilotPicture rendered(const Scene& scene, const Camera& camera, const MethodRow& row,
                      Technique::By kind, const RenderSettings& settings,
                      const ThreadPool& threads) {
    const std::unique_ptr<Method> method = row.create(resolve(row, {}));
    BidirIntegrator integrator(scene, camera, row.techniques, *method, settings, threads);
    const auto [width, height] = camera.film();
    const auto pixels = std::size_t(width) * std::size_t(height);
    PilotPicture pilot{width, {}, {}, 0.0, 0.0};
    const std::atomic<bool> never{false};
    IterationStatistics statistics;
    std::vector<Rgb> picture(pixels);
    for (std::uint32_t i = 0; i < 2; ++i) {
        pilot.own[i].assign(pixels, 0.0);
        pilot.rest[i].resize(pixels);
        integrator.delivery().setObserver([&](const PathEvent& event) {
            const auto value = double(mean(event.contribution));
            // This is the pixel of the task's own path: no other task adds to it.
            if (event.technique.by == kind && std::isfinite(value)) {
                pilot.own[i][event.pixel] += value;
            }
        });
        integrator.render(i, picture, never, statistics);
        for (std::size_t p = 0; p < pixels; ++p) {
            pilot.rest[i][p] = double(mean(picture[p])) - pilot.own[i][p];
        }
    }
    pilot.chainRays = double(statistics.rays[std::size_t(RayKind::Chain)]);
    pilot.otherRays = double(statistics.totalRays()) - pilot.chainRays;
    return pilot;
}

/// The best number of samples of the pilot's own technique, over those of the pilot. All rays in search of chains count
/// as the technique's cost.
double effortOf(const PilotPicture& pilot, const Range& range) {
    if (pilot.chainRays == 0.0) return 1.0;
    const std::size_t pixels = pilot.own[0].size();
    std::vector<double> sum(pixels);
    for (std::size_t p = 0; p < pixels; ++p) {
        sum[p] = 0.5 * (pilot.own[0][p] + pilot.own[1][p] + pilot.rest[0][p] + pilot.rest[1][p]);
    }
    const double meanOfAll = meanOf(sum);
    const std::vector<double> bright = smoothed<double>(sum, pilot.width);
    const auto squaresOf = [&](const std::array<std::vector<double>, 2>& part) {
        std::vector<double> squares(pixels);
        for (std::size_t p = 0; p < pixels; ++p) {
            const double level = bright[p] + kDark * meanOfAll;
            const double apart = level > 0.0 ? (part[0][p] - part[1][p]) / level : 0.0;
            squares[p] = 0.5 * apart * apart;
        }
        return squares;
    };
    const double ofOthers = meanWithoutSparks(squaresOf(pilot.rest)) / pilot.otherRays;
    const double ofOwn = meanOf(squaresOf(pilot.own)) / (kChainRay * pilot.chainRays);
    if (ofOwn == 0.0 && ofOthers == 0.0) return 1.0;
    return std::clamp(std::sqrt(ofOwn / ofOthers), range.least, range.most);
}

}  // namespace

GlassEffort glassEffortFor(const Scene& scene, const Camera& camera, const Techniques& techniques,
                           const RenderSettings& settings, const ThreadPool& threads) {
    const SmallFilm small(camera.film(), kPixels);
    const Camera smallCamera = camera.withFilm(small.film);
    RenderSettings pilot = settings;
    pilot.seed = 0;
    pilot.crop = small.crop;
    pilot.lightPaths = 0;
    pilot.sampling = Sampling::Independent;
    pilot.transparentBackground = false;
    pilot.glassEffort = {};
    const auto with = [](const char* method, bool Techniques::*one) {
        MethodRow row = findMethod(method);
        row.techniques.chains = row.techniques.refractions = row.techniques.knownWays = false;
        row.techniques.*one = true;
        return row;
    };
    const auto effortBy = [&](const MethodRow& row, Technique::By kind, const Range& range) {
        return effortOf(rendered(scene, smallCamera, row, kind, pilot, threads), range);
    };
    GlassEffort effort;
    const bool refracts =
        techniques.refract() && settings.smoothGlass && !settings.smoothGlass->empty();
    const bool goesKnownWays =
        techniques.goKnownWays() && settings.chainSeeds && settings.chainSeeds->anyOfLamps();
    if (refracts) {
        effort.refractions = effortBy(with("pt", &Techniques::refractions),
                                      Technique::By::Refraction, kOfRefractions);
    }
    if (goesKnownWays) {
        effort.knownWays =
            effortBy(with("pt", &Techniques::knownWays), Technique::By::Refraction, kOfRefractions);
    }
    if (techniques.searchForChains() && settings.chainSeeds && settings.chainSeeds->hasPoints()) {
        // Where light paths splat, fewer paths are left to chains.
        MethodRow row = with(techniques.splats ? "bpt" : "pt", &Techniques::chains);
        row.techniques.refractions = refracts;
        row.techniques.knownWays = goesKnownWays;
        pilot.glassEffort = effort;
        effort.chains = effortBy(row, Technique::By::Chain, kOfChains);
    }
    return effort;
}

}  // namespace lacuna
