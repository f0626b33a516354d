#include "render/session.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"
#include "libcore/bidir/features.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "render/black_picture.h"
#include "render/block_plan.h"
#include "render/live/layer_names.h"

namespace lacuna {
namespace {

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

/// Checks what the picture alone needs against what the machine has: better an error now than being
/// killed by the system after hours.
Film makeFilm(const RenderOptions& options, const RenderSettings& settings, BlockPlan plan) {
    const PixelRect& crop = settings.crop;
    const double depth = settings.limits.maxDepth;
    const double layers = options.techniques ? depth * (depth + 3.0) : 0.0;
    // Means and spreads of a dozen nodes of the tree, an iteration, and the layers on their way to
    // the file.
    const bool beside = options.displayServer || options.writeEverySeconds;
    const double perPixel = 12.0 * 24.0 + 12.0 + 104.0 + layers * 3.0 * sizeof(Rgb) +
                            (beside ? 104.0 + layers * 2.0 * sizeof(Rgb) : 0.0);
    const double bytes = perPixel * double(crop.width()) * double(crop.height());
    const double available = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
    if (available > 0.0 && bytes > available) {
        throw RunError("memory: expected " + std::to_string(std::lround(bytes * 1e-9)) +
                       " GB for the picture, found a machine of " +
                       std::to_string(std::lround(available * 1e-9)) +
                       " GB; use a smaller picture, --crop" +
                       (options.techniques ? " or a smaller --max-depth" : ""));
    }
    return Film(crop.width(), crop.height(), plan, options.blocks ? options.blocks->begin : 0);
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
      row_(row),
      methodSettings_(settings),
      method_(freshMethod()),
      plan_(planOf(options, *method_)),
      film_(makeFilm(options, stage_.settings, plan_)),
      pixels_(std::size_t(film_.width()) * std::size_t(film_.height())),
      end_(endOf(options, plan_)) {
    stage_.settings.blockIterations = plan_.iterations;
    integrator_ = std::make_unique<BidirIntegrator>(
        *stage_.scene, *stage_.camera, stage_.techniques, *method_, stage_.settings, pool_);
    if (options_.techniques) {
        techniques_.emplace(film_.width(), film_.height(), stage_.settings.limits.maxDepth);
        integrator_->delivery().setTechniqueFilm(&*techniques_);
        film_.addLayers(*techniques_);
    }
    if (options_.verify) {
        verifier_ = std::make_unique<WeightVerifier>(*stage_.scene, *stage_.camera,
                                                     stage_.settings.limits, pool_);
    }
    if (options_.techniques && !row.proposalLabels.empty()) {
        proposalLayers_.emplace(row.proposalLabels, film_.width(), film_.height());
        film_.addLayers(*proposalLayers_);
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
    r.blocks = plan_;
    r.firstBlock = film_.block();
    r.techniques = options.techniques;
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
    if (options.blocks || !options.checkpoint.empty()) inputs_ = inputs();
    if (!options.checkpoint.empty()) {
        checkpoint_.emplace(options.checkpoint, options.checkpointSeconds);
        if (std::optional<Part> part = checkpoint_->load(inputs_, report_.firstBlock)) {
            goOn(std::move(*part));
        }
    }
    loadReference();
    if (options_.writeEverySeconds) refresh_.emplace(*options_.writeEverySeconds);
    if (options_.displayServer) beginLiveView();
}

Session::~Session() = default;

std::unique_ptr<Method> Session::freshMethod() const {
    std::unique_ptr<Method> method = row_.create(methodSettings_);
    caches_.giveTo(*method);
    return method;
}

/// Whatever a pixel depends on.
CacheStamp Session::inputs() const {
    CacheStamp stamp{sceneInputs(stage_)};
    const auto add = [&](const std::string& name, const std::string& value) {
        stamp.inputs[name] = value;
    };
    for (const auto& [name, value] : stage_.viewInputs) add(name, value);
    for (const Effect& e : stage_.effects) {
        if (e.forced && !e.ofScene) add("effect " + e.name, e.simulated ? "on" : "off");
    }
    for (const auto& [name, value] : methodSettings_) add(name, value);
    for (const auto& [name, hash] : caches_.hashes) add("cache " + name, hash);
    const PixelRect& crop = stage_.settings.crop;
    add("version", LACUNA_VERSION);
    add("program", hashOfFile("/proc/self/exe"));  // another build may round in another way
    add("method", row_.name);
    add("seed", std::to_string(options_.common.seed));
    add("film", std::to_string(report_.filmWidth) + " x " + std::to_string(report_.filmHeight));
    add("crop", std::to_string(crop.x0) + "," + std::to_string(crop.x1) + "," +
                    std::to_string(crop.y0) + "," + std::to_string(crop.y1));
    add("technique layers", options_.techniques ? "yes" : "no");
    add("iterations of a block", std::to_string(plan_.iterations));
    return stamp;
}

/// From what a checkpoint holds.
void Session::goOn(Part part) {
    totals_ = {part.seconds, part.statistics};
    if (part.sums.open.empty()) ofBlocks_ = totals_;
    film_.restore(std::move(part.sums), pool_);
    if (end_ > 0 && film_.nextIteration() > end_) {
        throw InputError(options_.checkpoint + ": expected a checkpoint of at most " +
                         std::to_string(end_) + " iterations, found " +
                         std::to_string(film_.nextIteration()) +
                         "; ask for no fewer --iterations, or name another file");
    }
    progress_.remark(options_.checkpoint + ": goes on from iteration " +
                     std::to_string(film_.nextIteration()));
}

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
    if (!options_.log.empty()) log_.emplace(options_.log, film_.iterations());
}

int Session::run() {
    render();
    if (checkpoint_) finishCheckpoint();
    save();
    warnAboutDefects();
    if (!failure_.empty()) throw RunError(failure_);
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

/// A method as new, warmed up. False where an interrupt came first.
bool Session::beginBlock() {
    std::unique_ptr<Method> fresh = freshMethod();
    // What a block's warm-up counts is counted once, whoever goes on in the middle of it.
    const bool first = film_.iterations() == 0, again = film_.inBlock() > 0;
    Totals ofWarmUp;
    bool complete = false;
    {
        const Stopwatch watch(ofWarmUp.seconds);
        complete = integrator_->beginBlock(
            film_.block(), *fresh, first ? kNever : interrupt_.requested(), ofWarmUp.statistics);
    }
    method_ = std::move(fresh);
    if (complete && !again) {
        totals_.seconds += ofWarmUp.seconds;
        totals_.statistics.add(ofWarmUp.statistics);
    }
    return complete;
}

/// False where an interrupt came first.
bool Session::renderIteration() {
    // The first iteration is always finished, so that there is something to save. So is every one
    // with layers: a part of one in them could not be taken out again.
    const bool first = film_.iterations() == 0;
    const std::atomic<bool>& cancel = first || techniques_ ? kNever : interrupt_.requested();
    Totals ofIteration;
    {
        const Stopwatch watch(ofIteration.seconds);
        if (!integrator_->render(std::uint32_t(film_.nextIteration()), pixels_, cancel,
                                 ofIteration.statistics)) {
            return false;
        }
        if (proposalLayers_) proposalLayers_->countIteration();
        film_.add(pixels_, pool_);
    }
    totals_.seconds += ofIteration.seconds;
    totals_.statistics.add(ofIteration.statistics);
    if (film_.inBlock() == 0) ofBlocks_ = totals_;
    expectedSeconds_ = first ? ofIteration.seconds : 0.5 * (expectedSeconds_ + ofIteration.seconds);
    return true;
}

void Session::render() {
    const std::uint64_t limit = end_ > 0 ? end_ - report_.firstBlock * plan_.iterations : 0;
    const auto tell = [&] {
        report_.iterations = film_.iterations();
        report_.seconds = totals_.seconds;
        progress_.iterations({report_.iterations, limit, totals_.statistics.totalRays(),
                              report_.seconds, options_.timeSeconds.value_or(0.0)});
    };
    tell();
    bool begun = false;
    for (;;) {
        if (interrupt_.requested() && film_.iterations() > 0) {
            report_.stopped = "interrupt";
        } else if (end_ > 0 && film_.nextIteration() >= end_) {
            report_.stopped = "iterations";
        } else if (options_.timeSeconds && film_.iterations() > 0 && !mayBegin()) {
            report_.stopped = "time";
        }
        if (!report_.stopped.empty()) break;
        if (!begun) {
            if (report_.warmupIterations > 0) progress_.phase("warm-up");
            if (!beginBlock()) continue;
            progress_.phase("rendering");
            begun = true;
            tell();
        }
        if (!renderIteration()) continue;
        begun = film_.inBlock() > 0;
        tell();
        if (log_ && log_->wants(report_.seconds)) logRow();
        if (checkpoint_) saveCheckpoint();
        if (refresh_) refreshOutput();
        if (live_ && live_->wants()) showLive();
    }
    report_.statistics = totals_.statistics;
}

/// Layers that no iteration changes: what the lens sees first, and what belongs to it.
const LayeredImage& Session::still() {
    if (still_) return *still_;
    const Stopwatch watch(report_.phaseSeconds["features"]);
    still_.emplace(film_.width(), film_.height());
    setFeatures(*still_, renderFeatures(*stage_.scene, *stage_.camera, stage_.settings.crop,
                                        options_.common.seed, pool_));
    for (const auto& asset : caches_.assets) {
        asset->draw(*still_, *stage_.scene, *stage_.camera, stage_.settings.crop, pool_);
    }
    return *still_;
}

/// Of every channel that the picture may come to have.
std::vector<std::string> Session::channelNames() {
    std::vector<std::string> names;
    const auto addRgb = [&](const std::string& layer) {
        for (const char* part : {".R", ".G", ".B"}) names.push_back(layer + part);
    };
    addRgb("variance");
    for (const auto& [name, plane] : still().channels()) names.push_back(name);
    if (!options_.techniques) return names;
    for (const std::string& label : row_.proposalLabels) addRgb("part." + label);
    for (int k = 1; k <= report_.limits.maxDepth; ++k) {
        for (int s = 0; s <= k; ++s) {
            const std::string technique = TechniqueFilm::layerName(s, k + 1 - s);
            addRgb("weighted." + technique);
            addRgb("unweighted." + technique);
        }
    }
    names.push_back("share.t02");
    return names;
}

void Session::beginLiveView() {
    const std::vector<std::string>& layers = options_.displayLayers;
    const std::vector<std::string> all = layers.empty() ? layers : channelNames();
    live_.emplace(*options_.displayServer,
                  TevImage{options_.output, film_.width(), film_.height(),
                           channelsOfLayers("--display-layers", layers, all)},
                  [this](const std::string& text) { progress_.warning(text); });
}

/// What the viewer shows of it, and maybe more.
LayeredImage Session::shown(const FilmSum& sum) {
    if (!options_.displayLayers.empty()) return composeImage(report_, sum, &still());
    LayeredImage image(film_.width(), film_.height());
    image.setRgb("", sum.image(film_.width(), film_.height()));
    return image;
}

void Session::showLive() {
    double seconds = 0.0;
    LayeredImage image;
    {
        const Stopwatch watch(seconds);
        image = shown(film_.sum(&pool_));
    }
    live_->show(std::move(image), LiveView::Seconds(seconds));
}

/// --write-every: as it would be saved now.
void Session::refreshOutput() {
    if (const auto failure = refresh_->failure()) {
        progress_.warning("warning: " + *failure + " (the render goes on)");
    }
    if (!refresh_->due()) return;
    RenderReport now = report_;
    now.statistics = totals_.statistics;
    refresh_->begin([this, image = output(now, film_.sum(&pool_))] {
        if (endingOf(options_.output) == ".exr") {
            writeExr(options_.output, image, ExrCompression::None);  // the last one is compressed
        } else {
            writeImage(options_.output, image, options_.exposure);
        }
    });
}

/// What is written.
LayeredImage Session::output(const RenderReport& report, const FilmSum& sum) {
    const bool layers = endingOf(options_.output) == ".exr";
    LayeredImage image = composeImage(report, sum, layers ? &still() : nullptr);
    if (options_.blocks) {
        addPart(image, {inputs_, film_.width(), film_.height(), plan_, report_.firstBlock,
                        film_.finalState(pool_), totals_.seconds, totals_.statistics});
    }
    return image;
}

/// What the checkpoint holds now.
Part Session::part() const {
    // What a method has learned in an open block, and what the layers hold of it, is not saved.
    const bool withOpen = !method_->learns() && !techniques_;
    const Totals& totals = withOpen ? totals_ : ofBlocks_;
    return {inputs_,        film_.width(),      film_.height(),
            plan_,          report_.firstBlock, film_.state(withOpen),
            totals.seconds, totals.statistics};
}

void Session::saveCheckpoint() {
    if (const auto failure = checkpoint_->failure()) {
        progress_.warning("warning: " + *failure +
                          " (the render goes on; the last checkpoint is kept)");
    }
    if (!checkpoint_->due()) return;
    Part now = part();
    if (now.iterations() > 0) checkpoint_->save(std::move(now));
}

void Session::finishCheckpoint() {
    Part now = part();
    if (now.iterations() == 0) return;
    progress_.phase("saving the checkpoint");
    try {
        checkpoint_->finish(std::move(now));
    } catch (const std::exception& e) {
        failure_ = e.what();
    }
}

/// A picture that cannot be compared (an overflow to infinity) still is one: it is kept.
void Session::measure() {
    if (!reference_) return;
    const Stopwatch watch(report_.phaseSeconds["compare"]);
    try {
        report_.error = reference_->compare(film_.sum(&pool_).image(film_.width(), film_.height()),
                                            options_.output);
    } catch (const InputError& e) {
        report_.error.reset();
        failure_ = e.what();
    }
}

void Session::logRow() {
    measure();
    try {
        log_->write({report_.iterations, report_.seconds, report_.setupSeconds,
                     totals_.statistics.rays, report_.error, totals_.statistics.phaseSeconds});
    } catch (const RunError& e) {
        failure_ = e.what();
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
    const FilmSum sum = film_.sum(&pool_);
    report_.mean = sum.meanColour();
    warnIfBlack();
    if (verifier_) report_.verify = verifier_->result();

    progress_.phase("saving");
    if (live_) live_->showLast(shown(sum));
    const LayeredImage image = output(report_, sum);
    {
        const Stopwatch watch(report_.phaseSeconds["save"]);
        if (refresh_) refresh_->wait();  // or the older image would come last
        writeImage(options_.output, image, options_.exposure);
    }
    if (!options_.common.json.empty()) {
        writeJson(options_.common.json, reportJson(report_));
    }
    if (live_) live_->leave();
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
