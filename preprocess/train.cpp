// (theory.md, "Subspaces")
#include "preprocess/train.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/subspace/centroids.h"
#include "preprocess/tool_stage.h"

namespace lacuna {

namespace {

constexpr int kPicks = 3;                  // N for which Gamma is optimised
constexpr float kDirectionWeight = 0.05f;  // k_d of the centroids' metric [Su22 eq 18]
constexpr double kLightShare = 0.2;        // share of the light subspaces that divide the lights
constexpr std::size_t kTreeSamples = 400'000, kJudgedSamples = 100'000;
constexpr std::size_t kSamplesPerTask = 4096;
constexpr std::uint64_t kLightPathsPerTask = 8192;
constexpr std::uint32_t kLightPathIteration = 0xc0000000u;

/// Ends of subpaths and the contributions of their paths.
struct Ends {
    std::vector<SubpathEnd> end;
    std::vector<float> weight;
};

/// Regularly selected ends of one side, about `most` at most.
Ends endsOf(const TrainingPaths& paths, bool lightSide, std::size_t most) {
    const auto forEach = [&](const auto& body) {
        for (std::size_t n = 0; n < paths.size(); ++n) {
            const TrainingPaths::Path& p = paths.path(n);
            for (int s = lightSide ? 2 : 1; s < int(p.edges); ++s) {
                if (paths.strength(p, s) > 0.0f) body(p, s);
            }
        }
    };
    std::size_t count = 0;
    forEach([&](const TrainingPaths::Path&, int) { ++count; });
    const std::size_t step = std::max<std::size_t>(1, (count + most - 1) / most);
    Ends ends;
    std::size_t n = 0;
    forEach([&](const TrainingPaths::Path& p, int s) {
        if (n++ % step != 0) return;
        ends.end.push_back(lightSide ? paths.lightEnd(p, s) : paths.eyeEnd(p, s));
        ends.weight.push_back(p.contribution);
    });
    return ends;
}

std::vector<std::uint32_t> labelsOf(const Centroids& centroids, std::span<const SubpathEnd> ends,
                                    std::uint32_t first, const ThreadPool& pool) {
    std::vector<std::uint32_t> labels(ends.size());
    pool.forEach((ends.size() + kSamplesPerTask - 1) / kSamplesPerTask, [&](std::size_t task) {
        const std::size_t begin = task * kSamplesPerTask;
        for (std::size_t i = begin; i < std::min(ends.size(), begin + kSamplesPerTask); ++i) {
            labels[i] = first + centroids.nearest(ends[i]);
        }
    });
    return labels;
}

/// The nearest centroids by label. The first `first` labels do not belong to centroids.
std::vector<std::vector<std::uint32_t>> neighboursOf(const Centroids& centroids,
                                                     std::span<const SubpathEnd> centres,
                                                     std::uint32_t first, const ThreadPool& pool) {
    std::vector<std::vector<std::uint32_t>> near(first + centres.size());
    pool.forEach(centres.size(), [&](std::size_t n) {
        near[first + n] = centroids.nearest(centres[n], kMostNeighbours);
        for (std::uint32_t& label : near[first + n]) label += first;
    });
    return near;
}

double lookUpNanoseconds(const DecisionTree& tree, std::span<const SubpathEnd> ends) {
    if (ends.empty()) return 0.0;
    using Clock = std::chrono::steady_clock;
    std::uint64_t sum = 0;
    const Clock::time_point start = Clock::now();
    for (const SubpathEnd& e : ends) sum += tree(e);
    const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
    // The sum is never this large; using it keeps the compiler from removing the loop.
    return sum == ~std::uint64_t(0) ? 0.0 : ns / double(ends.size());
}

/// The classification of one side, from samples to a tree.
class Classification {
  public:
    Classification(const CollectedPaths& paths, bool lightSide)
        : train_(endsOf(paths.train, lightSide, kTreeSamples)),
          heldOut_(endsOf(paths.heldOut, lightSide, kJudgedSamples)) {}

    std::span<const SubpathEnd> ends() const { return train_.end; }

    /// Labels the ends by centroids. Labels count from `first`; there are at most `count` of them
    /// and at least one.
    void label(std::uint32_t first, std::size_t count, float sigma2, float directionWeight,
               Rng& rng, const ThreadPool& pool) {
        const auto centres = drawCentroids(train_.end, train_.weight, count, rng);
        const Centroids centroids(centres, sigma2, directionWeight);
        report_.centroids = centroids.size();
        labelCount_ = first + std::max<std::uint32_t>(1, std::uint32_t(centroids.size()));
        neighbours_ = neighboursOf(centroids, centres, first, pool);
        labels_ = labelsOf(centroids, train_.end, first, pool);
        heldOutLabels_ = labelsOf(centroids, heldOut_.end, first, pool);
        if (labels_.empty()) labels_ = {first}, train_.end = {SubpathEnd{}};
    }
    std::uint32_t labelCount() const { return labelCount_; }
    /// The nearest labels of each of `labels` labels, including itself. Labels without a centroid
    /// have only themselves.
    std::vector<std::vector<std::uint32_t>> neighbours(std::uint32_t labels) const {
        std::vector<std::vector<std::uint32_t>> all = neighbours_;
        all.resize(labels);
        for (std::uint32_t n = 0; n < labels; ++n) {
            if (all[n].empty()) all[n] = {n};
        }
        return all;
    }

    DecisionTree grow() {
        DecisionTree tree = growTree(train_.end, labels_, labelCount_);
        report_.samples = train_.end.size();
        report_.accuracy = treeAccuracy(tree, train_.end, labels_);
        report_.heldOutAccuracy = treeAccuracy(tree, heldOut_.end, heldOutLabels_);
        report_.depth = tree.depth();
        report_.leaves = tree.leaves();
        return tree;
    }
    TreeReport report(const DecisionTree& tree) {
        report_.nanoseconds = lookUpNanoseconds(tree, heldOut_.end);
        return report_;
    }

  private:
    Ends train_, heldOut_;
    std::vector<std::uint32_t> labels_, heldOutLabels_;
    std::vector<std::vector<std::uint32_t>> neighbours_;
    std::uint32_t labelCount_ = 1;
    TreeReport report_;
};

/// Measures Q(i) = (1/M') sum of mean(beta) over the vertices in i [Su22 eq 19], and their number /
/// M'.
void measureQ(const Scene& scene, const TrainingView& view, Subspaces& subspaces,
              const TrainSettings& settings, const ThreadPool& pool,
              const std::atomic<bool>& cancel) {
    struct Sums {
        std::vector<double> q, count;
    };
    const Walker walker(scene, view.guides, view.camera, view.limits);
    const std::uint64_t tasks = (settings.lightPaths + kLightPathsPerTask - 1) / kLightPathsPerTask;
    subspaces.lightPaths = settings.lightPaths;
    subspaces.q.assign(subspaces.lightCount, 0.0);
    subspaces.population.assign(subspaces.lightCount, 0.0);
    // Batches bound the memory of the sums. These are added in the order of tasks.
    constexpr std::uint64_t kBatch = 64;
    for (std::uint64_t first = 0; first < tasks; first += kBatch) {
        std::vector<Sums> sums(std::min(kBatch, tasks - first));
        pool.forEach(sums.size(), [&](std::size_t n) {
            if (cancel) return;
            sums[n].q.assign(subspaces.lightCount, 0.0);
            sums[n].count = sums[n].q;
            std::vector<PathVertex> path;
            std::vector<double> betas;
            std::vector<DecisionTree::Descent> descents;
            RayTally tally;
            const std::uint64_t begin = (first + n) * kLightPathsPerTask;
            for (std::uint64_t i = begin;
                 i < std::min(settings.lightPaths, begin + kLightPathsPerTask); ++i) {
                Rng rng(settings.seed, kLightPathIteration, StreamKind::LightPath, i);
                walker.traceLight(rng, tally, path);
                betas.clear();
                descents.clear();
                for (std::size_t s = 1; s <= path.size(); ++s) {
                    const PathVertex& y = path[s - 1];
                    if (int(y.index) > walker.limits().maxDepth - 2 || !y.connectable()) continue;
                    const double beta = double(mean(y.throughput));
                    if (!std::isfinite(beta)) continue;
                    betas.push_back(beta);
                    descents.push_back(
                        subspaces.toLightSubspace(y, s > 1 ? &path[s - 2] : nullptr));
                }
                finish(descents);
                for (std::size_t d = 0; d < descents.size(); ++d) {
                    sums[n].q[descents[d].label()] += betas[d];
                    sums[n].count[descents[d].label()] += 1.0;
                }
            }
        });
        if (cancel) throw InterruptedError("interrupted: nothing was written");
        for (const Sums& sum : sums) {
            for (std::size_t i = 0; i < sum.q.size(); ++i) {
                subspaces.q[i] += sum.q[i] / double(settings.lightPaths);
                subspaces.population[i] += sum.count[i] / double(settings.lightPaths);
            }
        }
    }
}

double emptyShareOfEye(const GammaData& data) {
    std::vector<bool> used(data.eyeCount, false);
    for (const GammaData::Entry& e : data.entries) used[e.eye] = true;
    return double(std::count(used.begin(), used.end(), false)) / double(used.size());
}

}  // namespace

CacheStamp subspaceStamp(const Settings& sceneInputs, const Settings& viewInputs,
                         const TrainingSettings& settings, const std::string& emission,
                         const std::string& walks) {
    CacheStamp stamp{sceneInputs};
    stamp.inputs.insert(viewInputs.begin(), viewInputs.end());
    for (const auto& [name, value] : trainingOptions().values(settings)) stamp.inputs[name] = value;
    stamp.inputs["emission"] = emission;
    stamp.inputs["walks"] = walks;
    return stamp;
}

Trained train(const Scene& scene, const TrainingView& view, const TrainSettings& settings,
              const CacheStamp& stamp, const ThreadPool& pool, const std::atomic<bool>& cancel,
              Phases& phases) {
    Trained result;
    Subspaces& s = result.file.subspaces;
    const auto run = [&](const char* name, const auto& work) {
        if (cancel) throw InterruptedError("interrupted: nothing was written");
        phases.run(name, work);
        result.peakBytes[name] = peakBytes();
    };
    CollectedPaths paths;
    run("paths", [&] {
        const auto cells = std::uint32_t(std::lround(kLightShare * settings.subspaces));
        const Lights& lights = view.guides.lights ? *view.guides.lights : scene.lights();
        s.cells = LightCells(lights, std::max(1u, cells));
        paths = collectPaths(scene, view, s.cells, settings.paths, settings.seed, pool, cancel);
        result.trainPaths = paths.train.size();
        result.heldOutPaths = paths.heldOut.size();
        result.traced = paths.traced;
        result.outliers = paths.outliers;
        result.pathBytes = paths.train.bytes() + paths.heldOut.bytes();
    });
    Classification light(paths, true), eye(paths, false);
    run("centroids", [&] {
        const float sigma2 = std::max(spatialVariance(light.ends()), spatialVariance(eye.ends()));
        Rng lightRng(settings.seed, kTrainingIteration, StreamKind::User, 0);
        Rng eyeRng(settings.seed, kTrainingIteration, StreamKind::User, 1);
        // With one subspace in total, the cell of the lights is also that of the subpaths.
        const std::uint32_t first = settings.subspaces == 1 ? 0 : s.cells.count();
        const std::uint32_t rest = settings.subspaces > first ? settings.subspaces - first : 1;
        light.label(first, rest, sigma2, kDirectionWeight, lightRng, pool);
        eye.label(0, settings.subspaces, sigma2, kDirectionWeight, eyeRng, pool);
        s.lightCount = std::max(light.labelCount(), s.cells.count());
        s.eyeCount = eye.labelCount();
    });
    run("trees", [&] {
        pool.forEach(2, [&](std::size_t n) {
            (n == 0 ? s.lightTree : s.eyeTree) = (n == 0 ? light : eye).grow();
        });
        result.lightTree = light.report(s.lightTree);
        result.eyeTree = eye.report(s.eyeTree);
    });
    run("light paths", [&] { measureQ(scene, view, s, settings, pool, cancel); });
    run("gamma", [&] {
        const GammaData data = gammaData(paths.train, s, kPicks, pool);
        const GammaData heldOut = gammaData(paths.heldOut, s, kPicks, pool);
        const FullGamma full =
            fullGamma(data, {light.neighbours(s.lightCount), eye.neighbours(s.eyeCount)}, pool);
        result.gamma =
            optimiseGamma(data, heldOut, full, {settings.epochs, settings.borrow}, pool, cancel);
        s.gamma.assign(result.gamma.gamma.begin(), result.gamma.gamma.end());
        result.emptyEye = emptyShareOfEye(data);
    });
    result.emptyLight = double(std::count(s.q.begin(), s.q.end(), 0.0)) / double(s.q.size());
    result.file.stamp = stamp;
    result.file.contentHash = s.contentHash();
    return result;
}

}  // namespace lacuna
