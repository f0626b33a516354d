#include "render/choose/choose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/text_list.h"
#include "render/block_plan.h"
#include "render/choose/processor_share.h"
#include "render/choose/trial.h"

namespace lacuna {
namespace {

// Of what the render may take. (theory.md, "auto")
constexpr double kTrialShare = 0.008;    // of each candidate
constexpr double kTrainingShare = 0.08;  // of the subspaces, which trials and picture share
constexpr double kFewestTrialRays = 4e4;
constexpr double kMostTrialRays = 2e6;  // more would tell nothing new

/// Of the picture, where it is an error that ends it.
constexpr std::uint64_t kIterationsToAnError = 256;

/// A path of training costs as much as so many rays of a render, three times as many where few of
/// those that are tried carry light.
constexpr double kRaysPerTrainingPath = 50.0;
constexpr double kFewestTrainingPaths = 4000.0, kMostTrainingPaths = 1'024'000.0;

constexpr double kRaysPerPixel = 10.0;  // and iteration, about: sizes the pilot's picture
constexpr double kTrialIterations = 8.0;
constexpr double kFewestPixels = 256.0, kMostPixels = 6144.0;
constexpr double kMostFilmPixels = 1e5;           // around a crop, for rows that see all of it
constexpr double kPixelsPerThread = 512.0;        // two tiles
constexpr std::uint64_t kTrialSubpaths = 10'000;  // of pools in trials: small pictures need no more
constexpr std::uint64_t kSplatsPerPoolSubpath = 8;
constexpr std::uint64_t kFewestSubpaths = 1000, kMostSubpaths = 100'000;
constexpr double kSplatsPerCropPixel = 4.0;
constexpr double kFewestSplats = 10'000.0;

/// What is tried, and what a ray costs with it beside one of bpt: look-ups and waiting included. It
/// differs by scene, so with a time limit the trial's own seconds count.
struct Row {
    const char* method;
    double rayCost;
    double fall;   ///< errors go by iterations to the power of -fall, where numbers are even
    double alike;  ///< variances by pixels to the power of -alike: neighbours see more alike
    const char* strength;    ///< behind "light ", where it wins
    bool wholeFilm = false;  ///< an iteration costs as much as the film is large, whatever the crop
    const char* setting = nullptr;  ///< of the row, beside what is measured

    std::string name() const {
        return setting ? std::string(method) + " with " + setting : std::string(method);
    }
};
constexpr Row kRows[] = {
    {"bpt", 1.0, 0.54, 0.0, "is found from both ends"},
    {"pt", 1.1, 0.58, 0.0, "is found from the eye alone"},
    {"sharebpt", 1.5, 0.53, 0.07,
     "comes by ways that can be learned, and neighbouring pixels see much the same"},
    {"sharebpt", 1.6, 0.53, 0.07, "comes through glass or mirrors on both sides", false,
     "merge=on"},
    {"vcm", 1.4, 0.53, 0.0, "comes through glass or mirrors", true},
};
/// Where trials find nothing clearly better.
constexpr const char* kUsual = "sharebpt";

constexpr const char* kPhase = "choosing a method";

/// Training with about `paths`, a power of two times the fewest, and what goes with so many: renders
/// that may take about the same find the same cache.
std::vector<std::string> subspaceSettings(double paths, std::uint64_t subpaths) {
    const double ratio =
        std::clamp(paths, kFewestTrainingPaths, kMostTrainingPaths) / kFewestTrainingPaths;
    const double factor = std::exp2(std::round(std::log2(ratio)));
    const double p = kFewestTrainingPaths * factor;
    const auto rounded = [](double value) { return std::to_string(std::llround(value)); };
    return {"candidates=" + std::to_string(subpaths), "train.paths=" + rounded(p),
            "train.subspaces=" + rounded(std::min(40.0 * std::pow(factor, 0.6), 1000.0)),
            "train.light_paths=" + rounded(std::min(4.0 * p + 4000.0, 2e6)),
            "train.epochs=" + rounded(std::clamp(factor, 5.0, 20.0))};
}

/// Whether its picture is consistent, not unbiased.
bool merges(const Row& candidate) {
    const MethodRow& row = findMethod(candidate.method);
    std::vector<std::string> assignments;
    if (candidate.setting) assignments.push_back(candidate.setting);
    return isConsistentOnly(row, resolve(row, assignments));
}

bool learns(const MethodRow& row) {
    return std::any_of(row.needs.begin(), row.needs.end(),
                       [](const AssetNeed& need) { return need.name == "subspaces"; });
}

/// A row that was tried.
struct Tried {
    const Row* row = nullptr;
    Trial trial;
    Verdict verdict;
    double cost = 0.0;  ///< of an iteration of the picture, as a share of the budget
};

class Pilot {
  public:
    Pilot(const RenderOptions& options, const Stage& stage, const ThreadPool& pool,
          const std::atomic<bool>& cancel, Progress& progress)
        : options_(options), stage_(stage), pool_(pool), cancel_(cancel), progress_(progress) {}

    RowChoice choose(const std::function<void(const Image&)>& show) {
        sizeUp();
        show(enlarged(*small_, tried_.front().trial.halves, stage_.settings.crop));
        for (const Row& row : std::span(kRows).subspan(1)) {
            if (row.wholeFilm && smallFilmPixels() > kMostFilmPixels) continue;
            if (!options_.allowBias && merges(row)) continue;
            if (mayKeepCaches(row)) tryRow(row);
        }
        judge();
        return best();
    }

  private:
    bool byClock() const { return !options_.iterations && options_.timeSeconds; }

    /// What the whole render may take, and the pilot with it: from a first trial of bpt.
    void sizeUp() {
        const PixelRect& crop = stage_.settings.crop;
        const double pixels = double(crop.width()) * double(crop.height());
        // Speeds are measured on as many tiles as keep all threads busy.
        const double busy = byClock() ? kPixelsPerThread * double(pool_.threads()) : kFewestPixels;
        small_.emplace(stage_.camera->film(), stage_.settings.crop, std::min(pixels, busy));
        Trial first;
        const ProcessorShare processors;
        run(kRows[0], assignments(kRows[0], 0), kFewestTrialRays / 4.0, first);
        budget_ = double(iterations()) * first.rays;
        if (byClock()) {
            seconds_ = *options_.timeSeconds;
            if (options_.countSetup) seconds_ = std::max(0.1, seconds_ - stage_.setupSeconds);
            seconds_ *= processors.value();
            budget_ = seconds_ * first.rays / first.seconds;
        }
        rays_ = std::clamp(kTrialShare * budget_, kFewestTrialRays, kMostTrialRays);
        const double wanted = rays_ / (kRaysPerPixel * kTrialIterations);
        small_.emplace(stage_.camera->film(), stage_.settings.crop,
                       std::clamp(wanted, kFewestPixels, kMostPixels));
        tryRow(kRows[0]);
    }

    std::uint64_t iterations() const {
        if (options_.iterations) return std::uint64_t(*options_.iterations);
        return options_.until ? kIterationsToAnError : kDefaultIterations;
    }

    double smallFilmPixels() const { return pixelsOf(small_->film); }

    std::vector<std::string> assignments(const Row& candidate, std::uint64_t subpaths) const {
        const MethodRow& row = findMethod(candidate.method);
        std::vector<std::string> result;
        if (learns(row)) {
            result = subspaceSettings(kTrainingShare * budget_ / kRaysPerTrainingPath, subpaths);
        }
        if (candidate.setting) result.push_back(candidate.setting);
        if (const std::uint64_t splats = splatsOfCrop(); row.techniques.splats && splats > 0) {
            result.push_back("light_paths=" + std::to_string(splats));
        }
        return result;
    }

    /// Some of those that splat, which are traced anyway. A small pool lies in the processor's caches
    /// and serves as well: what its vertices have in common is the smaller part of the variance.
    std::uint64_t poolSubpaths() const {
        const std::uint64_t splats = splatsOfCrop();
        const std::uint64_t traced = splats > 0 ? splats : std::uint64_t(filmPixels());
        return std::clamp<std::uint64_t>(traced / kSplatsPerPoolSubpath, kFewestSubpaths,
                                         kMostSubpaths);
    }

    std::uint64_t trialSubpaths() const { return std::min(poolSubpaths(), kTrialSubpaths); }

    /// Light subpaths that splat, where a crop is so small a part of the picture that one per pixel
    /// of the whole would take most of the time; else 0, as many as pixels.
    std::uint64_t splatsOfCrop() const {
        const PixelRect& crop = stage_.settings.crop;
        const double wanted = std::max(
            kFewestSplats, kSplatsPerCropPixel * double(crop.width()) * double(crop.height()));
        return wanted < filmPixels() ? std::uint64_t(wanted) : 0;
    }

    /// A folder that cannot be written is a reason to do without, not to fail.
    bool mayKeepCaches(const Row& row) const {
        if (!learns(findMethod(row.method))) return true;
        const std::string directory =
            cacheDirectory(options_.scene, options_.common.cacheDirectory);
        try {
            makeCacheDirectory(directory + "/x");
            const AtomicFile probe(directory + "/x");
            return true;
        } catch (const RunError& e) {
            progress_.warning("warning: auto does without " + row.name() + ": " + e.what());
            return false;
        }
    }

    void tryRow(const Row& row) {
        Tried tried;
        tried.row = &row;
        run(row, assignments(row, trialSubpaths()), rays_ / row.rayCost, tried.trial);
        tried.cost =
            byClock() ? tried.trial.seconds / seconds_ : tried.trial.rays * row.rayCost / budget_;
        tried_.push_back(std::move(tried));
    }

    double filmPixels() const { return pixelsOf(stage_.camera->film()); }

    void run(const Row& candidate, const std::vector<std::string>& assignments, double rays,
             Trial& trial) {
        const MethodRow& row = findMethod(candidate.method);
        const Settings settings = resolve(row, assignments);
        RenderOptions options = options_;
        options.prepare = true;
        Caches caches;
        if (!needsOf(row, settings).empty()) {
            caches = loadCaches(options, row, settings, stage_, pool_, cancel_, progress_);
            progress_.phase(kPhase, kNothingWritten);
        }
        // A seed of its own for each: they would share eye subpaths, and so noise.
        const std::uint64_t seed = stage_.settings.seed * 0x9e3779b97f4a7c15u + ++runs_;
        const double poolScale = candidate.wholeFilm
                                     ? filmPixels() / smallFilmPixels()
                                     : double(poolSubpaths()) / double(trialSubpaths());
        if (!runTrial(stage_, *small_, row, settings, caches, poolScale, sampling(), seed, rays,
                      pool_, cancel_, trial)) {
            throw InterruptedError("interrupted: nothing was written");
        }
    }

    void judge() {
        std::vector<HalfPictures> pictures;
        for (const Tried& t : tried_) pictures.push_back(t.trial.halves);
        const std::vector<double> errors = errorsOf(pictures, small_->crop.width());
        // What rows without merging lack, however long they render.
        const auto doesMerge = [](const Tried& t) { return !t.trial.onlyMerged.empty(); };
        double lacking = 0.0;
        for (const Tried& t : tried_) {
            if (!doesMerge(t)) continue;
            lacking = std::max(
                lacking, errorWithout(t.trial.onlyMerged, t.trial.halves, small_->crop.width()));
        }
        for (std::size_t i = 0; i < tried_.size(); ++i) {
            Tried& t = tried_[i];
            const double left = doesMerge(t) ? 0.0 : lacking * lacking;
            t.verdict = {errors[i], errors[i] * errors[i] * shareLeft(t) + left};
        }
    }

    /// What is left at the end of the square of the trial's error: noise of one iteration times its
    /// cost, which is a share of the budget, less where pixels share what they find and are more than
    /// the trial's, and less where numbers are even over more iterations than a half of the trial has.
    /// What was trained is there already.
    double shareLeft(const Tried& t) const {
        const double ofAll = double(t.trial.iterations) * t.cost;  // of the picture's iterations
        const double left = ofAll * std::pow(small_->scale, -t.row->alike);
        if (sampling() == Sampling::Independent) return left;
        return left * std::pow(std::min(1.0, 0.5 * ofAll), 2.0 * t.row->fall - 1.0);
    }

    RowChoice best() const {
        const Tried& bpt = tried_.front();
        std::size_t usual = 0;  // bpt, where the usual one was not tried
        std::vector<Verdict> verdicts;
        for (std::size_t i = 0; i < tried_.size(); ++i) {
            verdicts.push_back(tried_[i].verdict);
            if (tried_[i].row->name() == kUsual) usual = i;
        }
        const Tried& chosen = tried_[rowToTake(verdicts, usual)];
        RowChoice choice{
            chosen.row->method, assignments(*chosen.row, poolSubpaths()), sampling(), "", {}};
        // Where nothing was seen all are alike.
        const auto speed = [&](const Tried& t) {
            return t.verdict.loss > 0.0 ? bpt.verdict.loss / t.verdict.loss : 1.0;
        };
        for (const Tried& t : tried_) choice.speeds.emplace_back(t.row->name(), speed(t));
        if (&chosen == &bpt || speed(chosen) <= 1.0) {
            choice.why = "no other method was clearly better in a pilot";
        } else {
            char times[64];
            std::snprintf(times, sizeof times, "%.2g times as fast as bpt in a pilot",
                          speed(chosen));
            choice.why = std::string(times) + ": light " + chosen.row->strength;
        }
        return choice;
    }

    Sampling sampling() const {
        return options_.samplerText.empty() ? Sampling::Sobol : options_.sampling;
    }

    const RenderOptions& options_;
    const Stage& stage_;
    const ThreadPool& pool_;
    const std::atomic<bool>& cancel_;
    Progress& progress_;
    std::optional<SmallFilm> small_;
    double budget_ = 0.0;   ///< of the render, in rays of bpt
    double seconds_ = 0.0;  ///< of the render, where its time is limited: what other programs leave
    double rays_ = 0.0;     ///< of a trial, in rays of bpt
    std::uint64_t runs_ = 0;
    std::vector<Tried> tried_;  ///< bpt first
};

}  // namespace

std::string triedMethods() {
    return joined(kRows, ", ", &Row::name);
}

RowChoice chooseMethod(const RenderOptions& options, const Stage& stage, const ThreadPool& pool,
                       const std::atomic<bool>& cancel, Progress& progress,
                       const std::function<void(const Image&)>& show) {
    progress.phase(kPhase, kNothingWritten);
    if (stage.scene->lights().empty()) return {"pt", {}, options.sampling, "there is no light", {}};
    return Pilot(options, stage, pool, cancel, progress).choose(show);
}

}  // namespace lacuna
