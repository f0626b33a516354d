#include "render/session.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/error.h"
#include "libcore/bidir/features.h"
#include "libcore/image/image_io.h"
#include "render/black_picture.h"

namespace lacuna {
namespace {

constexpr std::uint64_t kDefaultIterations = 64;
constexpr double kVerifyTolerance = 1e-4;
const std::atomic<bool> kNever{false};

/// Adds the time of its life to `seconds`.
class Stopwatch {
  public:
    explicit Stopwatch(double& seconds) : seconds_(seconds), start_(Clock::now()) {}
    ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

  private:
    using Clock = std::chrono::steady_clock;
    double& seconds_;
    Clock::time_point start_;
};

Image cropped(const Image& image, const PixelRect& rect) {
    Image part(rect.width(), rect.height());
    for (int y = 0; y < rect.height(); ++y) {
        for (int x = 0; x < rect.width(); ++x) part.at(x, y) = image.at(rect.x0 + x, rect.y0 + y);
    }
    return part;
}

std::uint64_t iterationLimit(const RenderOptions& options) {
    if (options.iterations) return std::uint64_t(*options.iterations);
    return options.timeSeconds ? 0 : kDefaultIterations;
}

/// Checks what the picture alone needs against what the machine has: better an error now than being
/// killed by the system after hours.
Film makeFilm(const RenderOptions& options, const RenderSettings& settings) {
    const PixelRect& crop = settings.crop;
    const double depth = settings.limits.maxDepth;
    const double layers = options.techniques ? depth * (depth + 3.0) : 0.0;
    // Sums and squares in double, an iteration, and the layers on their way to the file.
    const double perPixel = 48.0 + 12.0 + 104.0 + layers * 2.0 * sizeof(Rgb);
    const double bytes = perPixel * double(crop.width()) * double(crop.height());
    const double available = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
    if (available > 0.0 && bytes > available) {
        throw RunError("memory: expected " + std::to_string(std::lround(bytes * 1e-9)) +
                       " GB for the picture, found a machine of " +
                       std::to_string(std::lround(available * 1e-9)) +
                       " GB; use a smaller picture, --crop" +
                       (options.techniques ? " or a smaller --max-depth" : ""));
    }
    return Film(crop.width(), crop.height());
}

}  // namespace

Session::Session(const RenderOptions& options, const MethodRow& row, const Settings& settings,
                 const ThreadPool& pool, const InterruptGuard& interrupt, Progress& progress)
    : options_(options),
      pool_(pool),
      interrupt_(interrupt),
      progress_(progress),
      stage_(loadStage(options, row, settings, pool, progress)),
      caches_(loadCaches(options, row, settings, stage_, pool, interrupt.requested(), progress)),
      method_(row.create(settings)),
      film_(makeFilm(options, stage_.settings)) {
    caches_.giveTo(*method_);
    loadReference();
    integrator_ = std::make_unique<BidirIntegrator>(
        *stage_.scene, *stage_.camera, stage_.techniques, *method_, stage_.settings, pool_);
    if (options_.techniques) {
        techniques_.emplace(film_.width(), film_.height(), stage_.settings.limits.maxDepth);
        integrator_->delivery().setTechniqueFilm(&*techniques_);
    }
    if (options_.verify) {
        verifier_ = std::make_unique<WeightVerifier>(*stage_.scene, *stage_.camera,
                                                     stage_.settings.limits, pool_);
    }
    if (options_.techniques && !row.proposalLabels.empty()) {
        proposalLayers_.emplace(row.proposalLabels, film_.width(), film_.height());
    }
    if (verifier_ || proposalLayers_) {
        integrator_->delivery().setObserver([this](const PathEvent& event) {
            if (verifier_) verifier_->check(event);
            if (proposalLayers_) proposalLayers_->add(event);
        });
    }

    RenderReport& r = report_;
    r.commandLine = options.commandLine;
    r.method = &row;
    r.settings = settings;
    r.seed = options.common.seed;
    r.threads = pool.threads();
    r.filmWidth = stage_.camera->film().width;
    r.filmHeight = stage_.camera->film().height;
    r.crop = stage_.settings.crop;
    r.limits = stage_.settings.limits;
    r.lightPaths = row.techniques.splats ? integrator_->lightPaths() : 0;
    r.warmupIterations = method_->warmupIterations();
    r.setupSeconds = stage_.setupSeconds + caches_.seconds;
    r.phaseSeconds = stage_.phaseSeconds;
    for (const auto& [phase, seconds] : caches_.phaseSeconds) r.phaseSeconds[phase] += seconds;
    r.cacheHashes = caches_.hashes;
    r.sceneHash = stage_.scene->description().contentHash;
    r.tolerance = options.tolerance;
    r.effects = stage_.effects;
    r.warnings = stage_.warnings;
    if (options.common.verbose) describeStage();
}

Session::~Session() = default;

void Session::describeStage() const {
    const Scene& scene = *stage_.scene;
    const auto& phases = stage_.phaseSeconds;
    char setup[128];
    std::snprintf(setup, sizeof setup,
                  ", setup %.3g s: parse %.3g, decode %.3g, meshes %.3g, build %.3g",
                  report_.setupSeconds, phases.at("parse"), phases.at("decode"),
                  phases.at("meshes"), phases.at("build"));
    progress_.remark(std::to_string(scene.triangleCount()) + " triangles, " +
                     std::to_string(scene.lights().size()) + " lights, radius " +
                     std::to_string(scene.radius()) + ", " + std::to_string(report_.threads) +
                     " threads, " + std::to_string(report_.lightPaths) +
                     " light paths per iteration" + setup);
}

void Session::loadReference() {
    if (!options_.reference.empty()) {
        Image image = readImage(options_.reference);
        const Camera::Film film = stage_.camera->film();
        if (image.width == film.width && image.height == film.height) {
            image = cropped(image, stage_.settings.crop);
        } else if (image.width != film_.width() || image.height != film_.height()) {
            throw InputError(options_.reference + ": expected " + std::to_string(film_.width()) +
                             " x " + std::to_string(film_.height()) + " pixels, found " +
                             std::to_string(image.width) + " x " + std::to_string(image.height) +
                             "; render at that size (--width, --height)");
        }
        reference_.emplace(std::move(image), options_.reference);
    }
    if (!options_.log.empty()) log_.emplace(options_.log);
}

int Session::run() {
    render();
    save();
    warnAboutDefects();
    if (!logFailure_.empty()) throw RunError(logFailure_);
    return report_.stopped == "interrupt" ? kInterruptedExit : 0;
}

/// The next iteration is taken to last as long as the last ones. It is begun if it ends in time, or
/// passes the limit by no more than half of itself and a tenth of the limit.
bool Session::mayBegin() const {
    const double limit = *options_.timeSeconds;
    const double spent = report_.seconds + (options_.countSetup ? report_.setupSeconds : 0.0);
    return spent < limit &&
           spent + expectedSeconds_ <= limit + std::min(0.5 * expectedSeconds_, 0.1 * limit);
}

void Session::render() {
    const std::uint64_t limit = iterationLimit(options_);
    const auto tell = [&] {
        progress_.iterations({report_.iterations, limit, report_.statistics.totalRays(),
                              report_.seconds, options_.timeSeconds.value_or(0.0)});
    };
    if (report_.warmupIterations > 0) progress_.phase("warm-up");
    {
        const Stopwatch watch(report_.seconds);
        integrator_->warmUp(kNever, report_.statistics);
    }
    progress_.phase("rendering");
    tell();
    std::vector<Rgb> pixels(std::size_t(film_.width()) * std::size_t(film_.height()));
    for (;;) {
        // The first iteration is always finished, so that there is something to save. So is every
        // one with technique layers: a part of one in them could not be taken out again.
        const bool first = report_.iterations == 0;
        const std::atomic<bool>& cancel = first || techniques_ ? kNever : interrupt_.requested();
        double seconds = 0.0;
        bool complete = false;
        IterationStatistics statistics;
        {
            const Stopwatch watch(seconds);
            complete =
                integrator_->render(std::uint32_t(report_.iterations), pixels, cancel, statistics);
            if (complete) film_.add(pixels, pool_);
        }
        report_.seconds += seconds;
        report_.statistics.add(statistics);
        if (complete) {
            expectedSeconds_ =
                report_.iterations == 0 ? seconds : 0.5 * (expectedSeconds_ + seconds);
            ++report_.iterations;
            if (log_ && log_->wants(report_.seconds)) logRow();
            tell();
        }
        if (interrupt_.requested()) {
            report_.stopped = "interrupt";
        } else if (limit > 0 && report_.iterations >= limit) {
            report_.stopped = "iterations";
        } else if (options_.timeSeconds && !mayBegin()) {
            report_.stopped = "time";
        }
        if (!report_.stopped.empty()) return;
    }
}

/// A picture that cannot be compared (an overflow to infinity) still is one: it is kept.
void Session::measure() {
    if (!reference_) return;
    const Stopwatch watch(report_.phaseSeconds["compare"]);
    try {
        report_.error = reference_->compare(film_.image(), options_.output);
    } catch (const InputError& e) {
        report_.error.reset();
        logFailure_ = e.what();
    }
}

void Session::logRow() {
    measure();
    try {
        log_->write({report_.iterations, report_.seconds, report_.setupSeconds,
                     report_.statistics.rays, report_.error, report_.statistics.phaseSeconds});
    } catch (const RunError& e) {
        logFailure_ = e.what();
        log_.reset();
    }
}

void Session::save() {
    if (!log_) {
        measure();
    } else if (log_->lastIteration() != report_.iterations) {
        logRow();
    }

    for (const auto& [phase, seconds] : report_.statistics.phaseSeconds) {
        report_.phaseSeconds[phase] += seconds;
    }
    report_.mean = film_.meanColour();
    warnIfBlack();
    if (verifier_) report_.verify = verifier_->result();

    progress_.phase("saving");
    std::optional<FeatureLayers> features;
    if (endingOf(options_.output) == ".exr") {
        const Stopwatch watch(report_.phaseSeconds["features"]);
        features = renderFeatures(*stage_.scene, *stage_.camera, stage_.settings.crop,
                                  options_.common.seed, pool_);
    }
    {
        const Stopwatch watch(report_.phaseSeconds["save"]);
        LayeredImage image = composeImage(report_, film_, features ? &*features : nullptr,
                                          techniques_ ? &*techniques_ : nullptr);
        if (proposalLayers_) proposalLayers_->writeTo(image, report_.iterations);
        if (features) {
            for (const auto& asset : caches_.assets) {
                asset->draw(image, *stage_.scene, *stage_.camera, stage_.settings.crop, pool_);
            }
        }
        writeImage(options_.output, image, options_.exposure);
    }
    if (!options_.common.json.empty()) {
        writeJson(options_.common.json, reportJson(report_));
    }
    const double rays = double(report_.statistics.totalRays());
    std::printf("%s: %d x %d pixels, %s, %llu iteration%s in %.3g s (setup %.3g s), %.4g rays%s\n",
                options_.output.c_str(), film_.width(), film_.height(),
                report_.method->name.c_str(), static_cast<unsigned long long>(report_.iterations),
                report_.iterations == 1 ? "" : "s", report_.seconds, report_.setupSeconds, rays,
                report_.stopped == "interrupt" ? " (interrupted)" : "");
    if (report_.error) {
        std::printf("mae %.6g rmse %.6g mape %.6g relmse %.6g\n", report_.error->mae,
                    report_.error->rmse, report_.error->mape, report_.error->relmse);
    }
    if (report_.verify) {
        std::printf("verify: largest difference of a weight %.3g over %llu paths\n",
                    report_.verify->maxDifference,
                    static_cast<unsigned long long>(report_.verify->paths));
    }
}

/// A scene without light was told so before. Nobody who interrupts wants to wait for causes.
void Session::warnIfBlack() {
    const auto& mean = report_.mean.mean;
    const bool black = mean[0] == 0.0 && mean[1] == 0.0 && mean[2] == 0.0;
    if (!black || stage_.scene->lights().empty() || report_.stopped == "interrupt") return;
    progress_.phase("looking for light");
    report_.warnings.push_back(whyBlack(stage_, *report_.method, pool_));
    progress_.warning("warning: " + options_.scene + ": " + report_.warnings.back());
}

std::string Session::replayCommand(const std::string& replay) const {
    return options_.commandLine + " --replay " + replay;
}

void Session::warnAboutDefects() {
    const IterationStatistics& s = report_.statistics;
    if (s.invalidSamples > 0) {
        progress_.warning("warning: " + std::to_string(s.invalidSamples) +
                          " samples were not finite, or their sums, and left out; see one with: " +
                          replayCommand(s.invalidReplays.at(0)));
    }
    if (report_.verify && !(report_.verify->maxDifference <= kVerifyTolerance)) {
        progress_.warning("warning: a weight differs from its full product by " +
                          std::to_string(report_.verify->maxDifference) +
                          "; see it with: " + replayCommand(report_.verify->replay));
    }
}

}  // namespace lacuna
