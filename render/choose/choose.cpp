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

// Shares of the render's budget. (theory.md, "auto")
constexpr double kTrialShare = 0.008;    // for each candidate
constexpr double kTrainingShare = 0.08;  // for the subspaces, which trials and picture share
constexpr double kFewestTrialRays = 4e4;
constexpr double kMostTrialRays = 2e6;  // more gives no new information

/// Assumed iterations of a picture that an error bound ends.
constexpr std::uint64_t kIterationsToAnError = 256;

/// Cost of a training path in rays of a render. It is three times as high if few of the traced
/// paths carry light.
constexpr double kRaysPerTrainingPath = 50.0;
constexpr double kFewestTrainingPaths = 4000.0, kMostTrainingPaths = 1'024'000.0;

constexpr double kRaysPerPixel = 10.0;  // per iteration, about; sizes the pilot's picture
constexpr double kTrialIterations = 8.0;
constexpr double kFewestPixels = 256.0, kMostPixels = 6144.0;
constexpr double kMostFilmPixels = 1e5;           // for rows that render the whole film
constexpr double kPixelsPerThread = 512.0;        // two tiles
constexpr std::uint64_t kTrialSubpaths = 10'000;  // pools in trials; small pictures need no more
constexpr std::uint64_t kSplatsPerPoolSubpath = 8;
constexpr std::uint64_t kFewestSubpaths = 1000, kMostSubpaths = 100'000;
constexpr double kSplatsPerCropPixel = 4.0;
constexpr double kFewestSplats = 10'000.0;

/// A method that is tried. rayCost is the cost of one of its rays relative to bpt, including look-ups and
/// waiting. It varies with the scene, so that with a time limit the trial's own seconds count
/// instead.
struct MethodCandidate {
    const char* method;
    double rayCost;
    double fall;           ///< with even numbers, errors ~ iterations^-fall
    double alike;          ///< variances ~ pixels^-alike: more pixels have more similar neighbours
    const char* strength;  ///< text after "light " if it wins
    bool wholeFilm = false;         ///< an iteration's cost depends on the film, not the crop
    const char* setting = nullptr;  ///< a fixed setting of the method

    std::string name() const {
        return setting ? std::string(method) + " with " + setting : std::string(method);
    }
};
constexpr MethodCandidate kCandidates[] = {
    {"bpt", 1.0, 0.54, 0.0, "is found from both ends"},
    {"pt", 1.1, 0.58, 0.0, "is found from the eye alone"},
    {"sharebpt", 1.5, 0.53, 0.07,
     "comes by ways that can be learned, and neighbouring pixels see much the same"},
    {"sharebpt", 1.6, 0.53, 0.07, "comes through glass or mirrors on both sides", false,
     "merge=on"},
    {"vcm", 1.4, 0.53, 0.0, "comes through glass or mirrors", true},
};
/// The choice if trials find nothing clearly better.
constexpr const char* kUsual = "sharebpt";

constexpr const char* kPhase = "choosing a method";

/// Settings of training with about `paths` paths. The number is rounded to the fewest times a power
/// of two, so that renders of similar budgets use the same cache.
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

/// Whether its picture is only consistent, not unbiased.
bool merges(const MethodCandidate& candidate) {
    const MethodRow& row = findMethod(candidate.method);
    std::vector<std::string> assignments;
    if (candidate.setting) assignments.push_back(candidate.setting);
    return isConsistentOnly(row, resolve(row, assignments));
}

bool learns(const MethodRow& row) {
    return std::any_of(row.needs.begin(), row.needs.end(),
                       [](const AssetNeed& need) { return need.name == "subspaces"; });
}

/// A candidate and its trial.
struct Tried {
    const MethodCandidate* candidate = nullptr;
    Trial trial;
    Verdict verdict;
    double cost = 0.0;  ///< cost of an iteration of the picture as a share of the budget
};

class Pilot {
  public:
    Pilot(const RenderOptions& options, const Stage& stage, const ThreadPool& pool,
          const std::atomic<bool>& cancel, Progress& progress)
        : options_(options), stage_(stage), pool_(pool), cancel_(cancel), progress_(progress) {}

    RowChoice choose(const std::function<void(const Image&)>& show) {
        sizeUp();
        show(enlarged(*small_, tried_.front().trial.halves, stage_.settings.crop));
        for (const MethodCandidate& candidate : std::span(kCandidates).subspan(1)) {
            if (candidate.wholeFilm && smallFilmPixels() > kMostFilmPixels) continue;
            if (!options_.allowBias && merges(candidate)) continue;
            if (mayKeepCaches(candidate)) tryOut(candidate);
        }
        judge();
        return best();
    }

  private:
    bool byClock() const { return !options_.iterations && options_.timeSeconds; }

    /// Determines the budgets of the render and of the pilot from a first trial of bpt.
    void sizeUp() {
        const PixelRect& crop = stage_.settings.crop;
        const double pixels = double(crop.width()) * double(crop.height());
        // To measure speeds, the picture must have enough tiles to keep all threads busy.
        const double busy = byClock() ? kPixelsPerThread * double(pool_.threads()) : kFewestPixels;
        small_.emplace(stage_.camera->film(), stage_.settings.crop, std::min(pixels, busy));
        Trial first;
        const ProcessorShare processors;
        run(kCandidates[0], assignments(kCandidates[0], 0), kFewestTrialRays / 4.0, first);
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
        tryOut(kCandidates[0]);
    }

    std::uint64_t iterations() const {
        if (options_.iterations) return std::uint64_t(*options_.iterations);
        return options_.until ? kIterationsToAnError : kDefaultIterations;
    }

    double smallFilmPixels() const { return pixelsOf(small_->film); }

    std::vector<std::string> assignments(const MethodCandidate& candidate,
                                         std::uint64_t subpaths) const {
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

    /// The size of the pool: a share of the light subpaths that splat, which are traced anyway. A small pool fits into
    /// the processor's caches and serves as well: the correlation due to its shared vertices is the smaller part of the
    /// variance.
    std::uint64_t poolSubpaths() const {
        const std::uint64_t splats = splatsOfCrop();
        const std::uint64_t traced = splats > 0 ? splats : std::uint64_t(filmPixels());
        return std::clamp<std::uint64_t>(traced / kSplatsPerPoolSubpath, kFewestSubpaths,
                                         kMostSubpaths);
    }

    std::uint64_t trialSubpaths() const { return std::min(poolSubpaths(), kTrialSubpaths); }

    /// Number of light subpaths that splat for a small crop, for which one per pixel of the whole
    /// picture would take most of the time. Else 0: as many as pixels.
    std::uint64_t splatsOfCrop() const {
        const PixelRect& crop = stage_.settings.crop;
        const double wanted = std::max(
            kFewestSplats, kSplatsPerCropPixel * double(crop.width()) * double(crop.height()));
        return wanted < filmPixels() ? std::uint64_t(wanted) : 0;
    }

    /// Whether caches of the candidate can be written. If not, the candidate is left out; this is no error.
    bool mayKeepCaches(const MethodCandidate& candidate) const {
        if (!learns(findMethod(candidate.method))) return true;
        const std::string directory =
            cacheDirectory(options_.scene, options_.common.cacheDirectory);
        try {
            makeCacheDirectory(directory + "/x");
            const AtomicFile probe(directory + "/x");
            return true;
        } catch (const RunError& e) {
            progress_.warning("warning: auto does without " + candidate.name() + ": " + e.what());
            return false;
        }
    }

    void tryOut(const MethodCandidate& candidate) {
        Tried tried;
        tried.candidate = &candidate;
        run(candidate, assignments(candidate, trialSubpaths()), rays_ / candidate.rayCost,
            tried.trial);
        tried.cost = byClock() ? tried.trial.seconds / seconds_
                               : tried.trial.rays * candidate.rayCost / budget_;
        tried_.push_back(std::move(tried));
    }

    double filmPixels() const { return pixelsOf(stage_.camera->film()); }

    void run(const MethodCandidate& candidate, const std::vector<std::string>& assignments,
             double rays, Trial& trial) {
        const MethodRow& row = findMethod(candidate.method);
        const Settings settings = resolve(row, assignments);
        RenderOptions options = options_;
        options.prepare = true;
        Caches caches;
        if (!needsOf(row, settings).empty()) {
            caches = loadCaches(options, row, settings, stage_, pool_, cancel_, progress_);
            progress_.phase(kPhase, kNothingWritten);
        }
        // Each trial has its own seed: with the same one they would share eye subpaths and thus
        // noise.
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
        // The error that rows without merging keep, however long they render.
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

    /// Share of the trial's squared error that remains at the end of the render: the noise of one iteration times its
    /// cost as a share of the budget. It is smaller for rows whose pixels share paths, because the picture has more
    /// pixels than the trial. With even numbers it is smaller again, because the render has more iterations than one
    /// half of the trial. Training is already done and not counted.
    double shareLeft(const Tried& t) const {
        const double ofAll = double(t.trial.iterations) * t.cost;  // of the picture's iterations
        const double left = ofAll * std::pow(small_->scale, -t.candidate->alike);
        if (sampling() == Sampling::Independent) return left;
        return left * std::pow(std::min(1.0, 0.5 * ofAll), 2.0 * t.candidate->fall - 1.0);
    }

    RowChoice best() const {
        const Tried& bpt = tried_.front();
        std::size_t usual = 0;  // bpt, if the usual row was not tried
        std::vector<Verdict> verdicts;
        for (std::size_t i = 0; i < tried_.size(); ++i) {
            verdicts.push_back(tried_[i].verdict);
            if (tried_[i].candidate->name() == kUsual) usual = i;
        }
        const Tried& chosen = tried_[rowToTake(verdicts, usual)];
        RowChoice choice{chosen.candidate->method,
                         assignments(*chosen.candidate, poolSubpaths()),
                         sampling(),
                         "",
                         {}};
        // If the trials saw no light, all speeds are 1.
        const auto speed = [&](const Tried& t) {
            return t.verdict.loss > 0.0 ? bpt.verdict.loss / t.verdict.loss : 1.0;
        };
        for (const Tried& t : tried_) choice.speeds.emplace_back(t.candidate->name(), speed(t));
        if (&chosen == &bpt || speed(chosen) <= 1.0) {
            choice.why = "no other method was clearly better in a pilot";
        } else {
            char times[64];
            std::snprintf(times, sizeof times, "%.2g times as fast as bpt in a pilot",
                          speed(chosen));
            choice.why = std::string(times) + ": light " + chosen.candidate->strength;
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
    double seconds_ = 0.0;  ///< time limit of the render, times the share of the processors
    double rays_ = 0.0;     ///< budget of a trial in rays of bpt
    std::uint64_t runs_ = 0;
    std::vector<Tried> tried_;  ///< bpt first
};

}  // namespace

std::string triedMethods() {
    return joined(kCandidates, ", ", &MethodCandidate::name);
}

RowChoice chooseMethod(const RenderOptions& options, const Stage& stage, const ThreadPool& pool,
                       const std::atomic<bool>& cancel, Progress& progress,
                       const std::function<void(const Image&)>& show) {
    progress.phase(kPhase, kNothingWritten);
    if (stage.scene->lights().empty()) return {"pt", {}, options.sampling, "there is no light", {}};
    return Pilot(options, stage, pool, cancel, progress).choose(show);
}

}  // namespace lacuna
