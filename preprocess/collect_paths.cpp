#include "preprocess/collect_paths.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/bidir/integrator.h"
#include "libcore/methods/registry.h"

namespace lacuna {

namespace {

constexpr std::uint64_t kMostIterations = 100;
constexpr int kBlocksAcross = 128;  // of the picture that contributions are relative to

bool isHeldOut(std::uint32_t pixel) {
    // By pixel: paths of one pixel share eye subpaths.
    return (pixel * 2654435761u >> 16) % 10 == 0;
}

/// A path of one collector's set and the sample that it came from.
struct Found {
    std::uint64_t sample;
    std::size_t collector, index;
};

struct Collector {
    TrainingPaths paths;
    std::vector<std::uint64_t> samples;  // by path
};

}  // namespace

TrainingView trainingView(const Camera& camera, double aspect, const WalkLimits& limits,
                          std::uint64_t paths) {
    aspect = std::clamp(aspect, 0.05, 20.0);
    // Some paths per pixel and iteration; more pixels for more paths, up to 256 x 144.
    const double pixels = std::clamp(double(paths) / 16.0, 256.0, 36864.0);
    const int width = std::max(1, int(std::lround(std::sqrt(pixels * aspect))));
    const int height = std::max(1, int(std::lround(pixels / width)));
    return {camera.withFilm({width, height}), limits};
}

CollectedPaths collectPaths(const Scene& scene, const TrainingView& view, const LightCells& cells,
                            std::uint64_t paths, std::uint64_t seed, const ThreadPool& pool,
                            const std::atomic<bool>& cancel) {
    const Camera& camera = view.camera;
    const Camera::Film film = camera.film();
    const MethodRow& row = findMethod("bpt");
    // Gamma reads p_t off the weights: all n r have to be one.
    const std::unique_ptr<Method> method =
        row.create(resolve(row, std::array{std::string("lamps=power")}));
    RenderSettings settings;
    settings.limits = view.limits;
    settings.seed = seed;
    settings.crop = {0, film.width, 0, film.height};
    BidirIntegrator integrator(scene, camera, row.techniques, *method, settings, pool);

    // Only ratios of contributions matter here: in the lights' own unit no sum of them overflows.
    const double unit = scene.lights().unit();
    const auto inLightUnit = [unit](const Rgb& c) {
        return Rgb(float(double(c.r) / unit), float(double(c.g) / unit), float(double(c.b) / unit));
    };
    std::vector<Collector> collectors(std::size_t(pool.threads()));
    integrator.delivery().setObserver([&](const PathEvent& event) {
        Collector& w = collectors[std::size_t(pool.workerIndex())];
        w.paths.add(event.path, event.counts, cells, mean(inLightUnit(event.contribution)),
                    event.pixel);
        if (w.paths.size() > w.samples.size()) w.samples.push_back(event.sample.number);
    });

    CollectedPaths result;
    std::vector<Rgb> pixels(std::size_t(film.width) * std::size_t(film.height)), sum(pixels.size());
    IterationStatistics statistics;
    std::uint64_t iterations = 1;
    double share = 1.0;  // of an iteration's paths that is kept, so that there are about `paths`
    for (std::uint64_t n = 0; n < iterations; ++n) {
        if (!integrator.render(kTrainingIteration + std::uint32_t(n), pixels, cancel, statistics)) {
            throw InterruptedError("interrupted: nothing was written");
        }
        for (std::size_t p = 0; p < pixels.size(); ++p) sum[p] += inLightUnit(pixels[p]);

        // In the order of samples, whatever the threads.
        std::vector<Found> found;
        for (std::size_t w = 0; w < collectors.size(); ++w) {
            for (std::size_t i = 0; i < collectors[w].samples.size(); ++i) {
                found.push_back({collectors[w].samples[i], w, i});
            }
        }
        std::stable_sort(found.begin(), found.end(),
                         [](const Found& a, const Found& b) { return a.sample < b.sample; });
        if (n == 0) {
            const double each = std::max(1.0, double(found.size()));
            iterations = std::uint64_t(
                std::clamp(std::ceil(double(paths) / each), 1.0, double(kMostIterations)));
            share = std::min(1.0, double(paths) / (each * double(iterations)));
        }
        double due = 0.0;
        for (const Found& f : found) {
            due += share;
            if (due < 1.0) continue;
            due -= 1.0;
            const TrainingPaths& from = collectors[f.collector].paths;
            const bool out = isHeldOut(from.path(f.index).pixel);
            (out ? result.heldOut : result.train).append(from, f.index);
        }
        result.traced += found.size();
        for (Collector& w : collectors) w = {};
    }
    result.iterations = iterations;
    for (Rgb& p : sum) p *= 1.0f / float(iterations);
    const int block = std::max(1, film.width / kBlocksAcross);
    result.train.relate(sum, film.width, block);
    result.heldOut.relate(sum, film.width, block);
    const float limit = result.train.outlierLimit();
    result.outliers = result.train.lowerTo(limit) + result.heldOut.lowerTo(limit);
    return result;
}

}  // namespace lacuna
