// Collects the picture's paths for training, by bidirectional path tracing. The result does not
// depend on the number of threads. Included by files that define their own kind of record.
// (theory.md, "Subspaces")
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <vector>

#include "libcore/base/error.h"
#include "libcore/bidir/integrator.h"
#include "libcore/methods/registry.h"
#include "libcore/subspace/relative_contribution.h"
#include "preprocess/training_view.h"

namespace lacuna {

/// The collected records. A Set has size(), pixel(i), append(other, i) and relate(scale).
template <class Set>
struct Collected {
    Set train, heldOut;        ///< contributions are relative to their pixels
    std::uint64_t traced = 0;  ///< contributing paths, including those left out
    std::uint64_t iterations = 0;
};

/// Whether the pixel's paths are held out; a tenth of the pixels is. Paths of one pixel share eye
/// subpaths, so that they must stay together.
inline bool isHeldOut(std::uint32_t pixel) {
    return (pixel * 2654435761u >> 16) % 10 == 0;
}

/// Collects about `paths` records, or as many as a hundred iterations give. `add` (set, event, mean
/// of the path's weighted contribution in the lights' unit) adds at most one record. `first`:
/// number of the first iteration, beyond those that renders reach, so that rendered paths are
/// independent of the training paths. Throws InterruptedError once `cancel` is set.
template <class Set, class Add>
Collected<Set> collect(const Scene& scene, const TrainingView& view, std::uint64_t paths,
                       std::uint64_t seed, std::uint32_t first, const ThreadPool& pool,
                       const std::atomic<bool>& cancel, const Add& add) {
    constexpr std::uint64_t kMostIterations = 100;
    constexpr int kBlocksAcross = 128;  // blocks of the picture to which contributions are relative
    struct Collector {
        Set records;
        std::vector<std::uint64_t> samples;  // by record
    };
    /// A record of one collector's set, and its sample.
    struct Found {
        std::uint64_t sample;
        std::size_t collector, index;
    };

    const Camera::Film film = view.camera.film();
    const MethodRow& row = findMethod("bpt");
    // Gamma derives p_t from the weights: all n r must be one.
    const std::unique_ptr<Method> method =
        row.create(resolve(row, std::array{std::string("lamps=power")}));
    RenderSettings settings;
    settings.limits = view.limits;
    settings.seed = seed;
    settings.crop = {0, film.width, 0, film.height};
    settings.guides = view.guides;
    BidirIntegrator integrator(scene, view.camera, row.techniques, *method, settings, pool);

    // Only ratios of contributions matter here. In the lights' unit, no sum of them overflows.
    const double unit = scene.lights().unit();
    const auto inLightUnit = [unit](const Rgb& c) {
        return Rgb(float(double(c.r) / unit), float(double(c.g) / unit), float(double(c.b) / unit));
    };
    std::vector<Collector> collectors(std::size_t(pool.threads()));
    integrator.delivery().setObserver([&](const PathEvent& event) {
        Collector& w = collectors[std::size_t(pool.workerIndex())];
        add(w.records, event, mean(inLightUnit(event.contribution)));
        if (w.records.size() > w.samples.size()) w.samples.push_back(event.sample.number);
    });

    Collected<Set> result;
    std::vector<Rgb> pixels(std::size_t(film.width) * std::size_t(film.height)), sum(pixels.size());
    IterationStatistics statistics;
    std::uint64_t iterations = 1;
    double share = 1.0;  // share of the paths that is kept, for about `paths` in total
    for (std::uint64_t n = 0; n < iterations; ++n) {
        if (!integrator.render(first + std::uint32_t(n), pixels, cancel, statistics)) {
            throw InterruptedError("interrupted: nothing was written");
        }
        for (std::size_t p = 0; p < pixels.size(); ++p) sum[p] += inLightUnit(pixels[p]);

        // Sorted by sample, independently of the threads.
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
            const Set& from = collectors[f.collector].records;
            (isHeldOut(from.pixel(f.index)) ? result.heldOut : result.train).append(from, f.index);
        }
        result.traced += found.size();
        for (Collector& w : collectors) w = {};
    }
    result.iterations = iterations;
    for (Rgb& p : sum) p *= 1.0f / float(iterations);
    const PixelScale scale(sum, film.width, std::max(1, film.width / kBlocksAcross));
    result.train.relate(scale);
    result.heldOut.relate(scale);
    return result;
}

}  // namespace lacuna
