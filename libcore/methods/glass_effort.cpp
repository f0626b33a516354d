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
#include "libcore/image/smoothed.h"
#include "libcore/methods/registry.h"

namespace lacuna {

namespace {

constexpr double kPixels = 4096;
/// Of the pixels, the noisiest ones, which do not count as noise of walks: more samples of the technique would take
/// their sparks away.
constexpr double kSparks = 0.01;
constexpr double kLeast = 1.0 / 16;
/// What a ray in search of a chain takes, Newton's method included, over what others take.
constexpr double kChainRay = 3.0;

/// Of the mean brightness, what is added to a pixel's: darkness is no reason for samples.
constexpr double kDark = 0.01;

double meanOf(std::span<const double> values) {
    return std::reduce(values.begin(), values.end()) / double(values.size());
}

Camera smallCamera(const Camera& camera) {
    const Camera::Film film = camera.film();
    const double scale =
        std::min(1.0, std::sqrt(kPixels / (double(film.width) * double(film.height))));
    const auto scaled = [&](int side) { return std::max(1, int(double(side) * scale)); };
    return camera.withFilm({scaled(film.width), scaled(film.height)});
}

/// The mean over the pixels but for the largest ones, which count as zero.
double meanWithoutSparks(std::vector<double> values) {
    const auto kept = std::size_t(std::ceil((1.0 - kSparks) * double(values.size())));
    std::ranges::nth_element(values, values.begin() + std::ptrdiff_t(kept) - 1);
    return std::reduce(values.begin(), values.begin() + std::ptrdiff_t(kept)) /
           double(values.size());
}

/// The best share of the samples of the one technique of the two that `techniques` have.
double effortOf(const Scene& scene, const Camera& camera, const Techniques& techniques,
                const RenderSettings& settings, const ThreadPool& threads) {
    const MethodRow& row = findMethod("pt");
    const std::unique_ptr<Method> method = row.create(resolve(row, {}));
    BidirIntegrator integrator(scene, camera, techniques, *method, settings, threads);
    const auto [width, height] = camera.film();
    const auto pixels = std::size_t(width) * std::size_t(height);
    // By iteration: what the technique brings to a pixel, and the rest.
    std::array<std::vector<double>, 2> own, rest;
    const std::atomic<bool> never{false};
    IterationStatistics statistics;
    std::vector<Rgb> picture(pixels);
    for (std::uint32_t i = 0; i < 2; ++i) {
        own[i].assign(pixels, 0.0);
        rest[i].assign(pixels, 0.0);
        integrator.delivery().setObserver([&](const PathEvent& event) {
            const auto value = double(mean(event.contribution));
            if (!std::isfinite(value)) return;
            (event.technique.refracts() ? own : rest)[i][event.pixel] += value;
        });
        integrator.render(i, picture, never, statistics);
    }
    const double chainRays = double(statistics.rays[std::size_t(RayKind::Chain)]);
    const double otherRays = double(statistics.totalRays()) - chainRays;
    if (chainRays == 0.0) return 1.0;

    std::vector<double> sum(pixels);
    for (std::size_t p = 0; p < pixels; ++p) {
        sum[p] = 0.5 * (own[0][p] + own[1][p] + rest[0][p] + rest[1][p]);
    }
    const double meanOfAll = meanOf(sum);
    const std::vector<double> bright = smoothed<double>(sum, width);
    const auto squaresOf = [&](const std::array<std::vector<double>, 2>& part) {
        std::vector<double> squares(pixels);
        for (std::size_t p = 0; p < pixels; ++p) {
            const double level = bright[p] + kDark * meanOfAll;
            const double apart = level > 0.0 ? (part[0][p] - part[1][p]) / level : 0.0;
            squares[p] = 0.5 * apart * apart;
        }
        return squares;
    };
    const double ofOthers = meanWithoutSparks(squaresOf(rest)) / otherRays;
    const double ofOwn = meanOf(squaresOf(own)) / (kChainRay * chainRays);
    return ofOthers > 0.0 ? std::clamp(std::sqrt(ofOwn / ofOthers), kLeast, 1.0) : 1.0;
}

}  // namespace

GlassEffort glassEffortFor(const Scene& scene, const Camera& camera, const Techniques& techniques,
                           const RenderSettings& settings, const ThreadPool& threads) {
    const Camera small = smallCamera(camera);
    RenderSettings pilot = settings;
    pilot.seed = 0;
    pilot.crop = {0, small.film().width, 0, small.film().height};
    pilot.lightPaths = 0;
    pilot.sampling = Sampling::Independent;
    pilot.transparentBackground = false;
    pilot.glassEffort = {};
    Techniques neither = findMethod("pt").techniques;
    neither.chains = neither.refractions = neither.knownWays = false;
    const auto effortOfOne = [&](bool Techniques::*one) {
        Techniques alone = neither;
        alone.*one = true;
        return effortOf(scene, small, alone, pilot, threads);
    };
    GlassEffort effort;
    if (techniques.refract() && settings.smoothGlass && !settings.smoothGlass->empty()) {
        effort.refractions = effortOfOne(&Techniques::refractions);
    }
    if (techniques.goKnownWays() && settings.chainSeeds && settings.chainSeeds->anyOfLamps()) {
        effort.knownWays = effortOfOne(&Techniques::knownWays);
    }
    return effort;
}

}  // namespace lacuna
