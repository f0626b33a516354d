#include "render/session.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/error.h"
#include "libcore/base/number_text.h"
#include "libcore/base/stopwatch.h"
#include "libcore/bidir/features.h"
#include "libcore/bidir/light_noise.h"
#include "libcore/bidir/mattes.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "libcore/image/sheet.h"
#include "render/black_picture.h"
#include "render/block_plan.h"
#include "render/live/layer_names.h"
#include "render/ranks/together.h"
#include "render/render_inputs.h"

namespace lacuna {
namespace {

constexpr double kVerifyTolerance = 1e-4;
constexpr double kEstimateSeconds = 5.0;  // least time of rendering for --estimate

Image cropped(const Image& image, const PixelRect& rect) {
    Image part(rect.width(), rect.height());
    for (int y = 0; y < rect.height(); ++y) {
        for (int x = 0; x < rect.width(); ++x) part.at(x, y) = image.at(rect.x0 + x, rect.y0 + y);
    }
    return part;
}

/// Makes the film. Checks its memory against that of the machine: an error now is better than being
/// killed by the system after hours.
Film makeFilm(const RenderOptions& options, const Stage& stage, BlockPlan plan) {
    const RenderSettings& settings = stage.settings;
    const PixelRect& crop = settings.crop;
    const double depth = settings.limits.maxDepth;
    const double groups = options.lightNoise ? double(stage.layers.lightGroups()) : 0.0;
    const double layers = (options.techniques ? depth * (depth + 3.0) : 0.0) +
                          double(stage.layers.names().size()) + groups * (groups + 1.0) / 2.0 +
                          (options.transparentBackground ? 1.0 / 3.0 : 0.0);
    // Means and spreads of a dozen nodes of the tree, one iteration, and copies of the layers for
    // the file.
    const bool beside = options.displayServer || options.writeEverySeconds;
    const double perPixel = 12.0 * 24.0 + 12.0 + 104.0 + layers * 4.0 * sizeof(Rgb) +
                            (beside ? 104.0 + layers * 2.5 * sizeof(Rgb) : 0.0);
    const double bytes = perPixel * double(crop.width()) * double(crop.height());
    const double available = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
    if (available > 0.0 && bytes > available) {
        throw RunError("memory: expected " + std::to_string(std::lround(bytes * 1e-9)) +
                       " GB for the picture, found a machine of " +
                       std::to_string(std::lround(available * 1e-9)) +
                       " GB; use a smaller picture, --crop" +
                       (options.techniques ? " or a smaller --max-depth" : "") +
                       (options.lightGroups ? " or fewer light groups" : "") +
                       (options.layers.empty() ? "" : " or fewer --layer"));
    }
    return Film(crop.width(), crop.height(), plan, options.blocks ? options.blocks->begin : 0);
}

}  // namespace

Session::Session(const RenderOptions& options, const MethodRow& row, const Settings& settings,
                 const std::optional<RowChoice>& choice, const Stage& stage, const Caches& caches,
                 const FirstLook& look, BlockMaker& maker, const Ranks& ranks,
                 const ThreadPool& pool, const std::atomic<bool>& interrupted, Progress& progress)
    : options_(options),
      pool_(pool),
      interrupted_(interrupted),
      progress_(progress),
      stage_(stage),
      caches_(caches),
      look_(look),
      maker_(maker),
      plan_(maker.plan()),
      film_(makeFilm(options, stage_, plan_)),
      end_(endOf(options, plan_)) {
    RenderReport& r = report_;
    r.commandLine = options.commandLine;
    r.method = &row;
    r.choice = choice;
    r.settings = settings;
    r.seed = options.common.seed;
    r.sampling = options.sampling;
    r.threads = pool.threads();
    r.ranks = ranks.size();
    r.filmWidth = stage_.camera->film().width;
    r.filmHeight = stage_.camera->film().height;
    r.crop = stage_.settings.crop;
    r.limits = stage_.settings.limits;
    r.glassEffort = stage_.settings.glassEffort;
    r.lightPaths = row.techniques.splats ? maker_.lightPaths() : 0;
    r.blocks = plan_;
    r.firstBlock = film_.block();
    r.techniques = options.techniques;
    for (const LayerExpression& layer : options.layers) r.layers[layer.name] = layer.text;
    if (options.lightGroups) r.lightGroups = stage_.scene->lightGroups().names;
    r.warmupIterations = maker_.warmupIterations();
    r.setupSeconds = stage_.setupSeconds + caches_.seconds;
    r.phaseSeconds = stage_.phaseSeconds;
    for (const auto& [phase, seconds] : caches_.phaseSeconds) r.phaseSeconds[phase] += seconds;
    r.cacheHashes = caches_.hashes;
    r.sceneHash = stage_.scene->description().contentHash;
    r.tolerance = options.tolerance;
    r.effects = stage_.effects;
    r.warnings = stage_.warnings;
    if (options.common.verbose) describeStage();
    film_.measure(look.meter);
    if (options.blocks || !options.checkpoint.empty()) {
        inputs_ = renderInputs(options, row, settings, stage, caches, plan_);
    }
    if (!options.checkpoint.empty()) {
        checkpoint_.emplace(options.checkpoint, options.checkpointSeconds);
        if (std::optional<Part> part = checkpoint_->load(inputs_, report_.firstBlock)) {
            goOn(std::move(*part));
        }
    }
    loadReference();
    if (options_.writeEverySeconds) refresh_.emplace(*options_.writeEverySeconds);
    if (options_.displayServer) beginLiveView();
    if (ranks.many()) {
        const double limit =
            options.timeSeconds.value_or(0.0) - (options.countSetup ? r.setupSeconds : 0.0);
        auto together = std::make_unique<Together>(ranks, maker_, look.meter, stage_.settings.crop,
                                                   Together::Limits{end_, std::max(0.0, limit)},
                                                   interrupted, pool);
        together_ = together.get();
        crew_ = std::move(together);
        return;
    }
    for (BlockLayers* layers : maker_.layers()) film_.addLayers(*layers);
    crew_ = std::make_unique<Alone>(maker_, interrupted, pool, progress);
}

Session::~Session() = default;

/// Continues from a checkpoint.
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
        const ImageFile file = openImage(options_.reference);
        const Camera::Film film = stage_.camera->film();
        const bool isWhole = file.size == ImageSize{film.width, film.height};
        if (!isWhole && file.size != ImageSize{film_.width(), film_.height()}) {
            throw InputError(options_.reference + ": expected " + std::to_string(film_.width()) +
                             " x " + std::to_string(film_.height()) + " pixels, found " +
                             std::to_string(file.size.width) + " x " +
                             std::to_string(file.size.height) +
                             "; render at that size (--width, --height)");
        }
        Image image = file.decode();
        if (isWhole) image = cropped(image, stage_.settings.crop);
        reference_.emplace(std::move(image), options_.reference);
    }
    if (!options_.log.empty()) log_.emplace(options_.log, film_.iterations());
}

Rendered Session::run() {
    render();
    if (crew_->cutShort()) {
        saveUnfinished();
        return finished(savedText());
    }
    if (options_.estimate) return costs();
    if (checkpoint_) finishCheckpoint();
    save();
    warnAboutDefects();
    return finished(savedText());
}

/// The picture's name in messages and viewers; it need not be a file.
const std::string& Session::pictureName() const {
    return options_.output.empty() ? options_.scene : options_.output;
}

Rendered Session::finished(std::string text) {
    return {std::move(report_), std::move(image_), std::move(text), std::move(failure_)};
}

/// Saves the unfinished first iteration as a picture. It is only good for viewing: no part,
/// checkpoint or estimate can be made from it.
void Session::saveUnfinished() {
    if (film_.iterations() == 0 || options_.blocks || options_.estimate) {
        throw InterruptedError(
            "interrupted: the first iteration was not finished: nothing "
            "was written");
    }
    report_.warnings.push_back(
        "the first iteration was not finished: pixels are missing or too dark");
    progress_.warning("warning: " + pictureName() + ": " + report_.warnings.back());
    log_.reset();
    save();
}

/// Whether another iteration may begin. It is assumed to take as long as the last ones. It begins
/// if it ends in time, or exceeds the limit by at most half its duration and a tenth of the limit.
bool Session::mayBegin() const {
    const double limit = *options_.timeSeconds, expected = crew_->iterationSeconds();
    const double spent = totals_.seconds + (options_.countSetup ? report_.setupSeconds : 0.0);
    return spent < limit && spent + expected <= limit + std::min(0.5 * expected, 0.1 * limit);
}

/// The reason to stop; empty: none yet.
std::string Session::whyStop() {
    if (crew_->cutShort()) return "interrupt";
    const bool some = film_.iterations() > 0;
    if (some && (interrupted_ || crew_->interrupted())) return "interrupt";
    if (isAccurate()) return "error";
    if (isEstimated()) return "estimate";
    if (end_ > 0 && film_.nextIteration() >= end_) return "iterations";
    if (some && options_.timeSeconds && !mayBegin()) return "time";
    return "";
}

/// Reports the current state to all listeners.
void Session::tell() {
    report_.iterations = film_.iterations();
    report_.seconds = totals_.seconds;
    const std::uint64_t limit = end_ > 0 ? end_ - report_.firstBlock * plan_.iterations : 0;
    const double bound = options_.until ? options_.until->error : 0.0;
    const ErrorNow now = errorNow().after(report_.seconds - estimateSeconds_);
    progress_.iterations({report_.iterations, limit, totals_.statistics.totalRays(),
                          report_.seconds, options_.timeSeconds.value_or(0.0),
                          estimateSeconds_ > 0.0 ? accuracyText(now, bound) : ""});
}

/// Called after iterations were added to the film: estimates, logs and saves.
void Session::keep() {
    if (film_.inBlock() == 0) ofBlocks_ = totals_;
    if (isMeasured(film_.iterations())) estimateErrorNow();
    tell();
    if (log_ && log_->wants(report_.seconds)) logRow();
    if (checkpoint_) saveCheckpoint();
    if (refresh_) refreshOutput();
    if (live_ && live_->wants()) showLive();
    progress_.picture([this] { return film_.image(idlePool()); });
}

void Session::render() {
    if (isMeasured(film_.iterations())) estimateErrorNow();
    tell();
    if (together_) progress_.phase("rendering");
    while ((report_.stopped = whyStop()).empty()) {
        if (crew_->advance(film_, totals_)) keep();
    }
    crew_->stop();
    // Iterations still being made when the time is over are added as well. A stop by error, however, happens after the
    // same iteration as with one process.
    const bool more = report_.stopped == "time" || report_.stopped == "interrupt";
    while (more) {
        if (crew_->advance(film_, totals_)) {
            keep();
        } else if (!crew_->busy()) {
            break;
        }
    }
    tell();
    report_.statistics = totals_.statistics;
    if (!together_) return;
    report_.receivedBytes = together_->receivedBytes();
    report_.phaseSeconds["pieces"] = together_->piecesSeconds();
}

/// Estimates the error. This happens at fixed iterations only, from data that checkpoints also
/// hold, so that a stop by error happens after the same iteration on any machine.
void Session::estimateErrorNow() {
    double seconds = 0.0;
    {
        const Stopwatch watch(seconds);
        report_.estimate = estimateError(film_.pictureSum(idlePool()), look_.meter, idlePool());
    }
    if (!together_) totals_.seconds += seconds;  // else other ranks rendered meanwhile
    estimateSeconds_ = totals_.seconds;
}

ErrorNow Session::errorNow() const {
    const std::string measure = options_.until ? options_.until->measure : "mape";
    const Measured& m = *report_.estimate.find(measure);
    return {measure, m.error, estimateSeconds_, !m.doubt.empty()};
}

/// Whether --until is reached. A picture without light is black and exact.
bool Session::isAccurate() {
    if (!options_.until || !isMeasured(film_.iterations())) return false;
    // Ranks deliver such blocks as a whole.
    if (maker_.blocksAreWhole() && film_.inBlock() > 0) return false;
    if (stage_.scene->lights().empty()) return true;
    const Measured& m = *report_.estimate.find(options_.until->measure);
    if (!(m.error < options_.until->error)) return false;
    if (!m.doubt.empty() && !doubtSaid_) {
        doubtSaid_ = true;
        progress_.remark("--until: cannot be promised yet: " + m.doubt);
    }
    return m.doubt.empty();
}

/// Whether --estimate has rendered long enough: some seconds, and four times as many if the
/// estimate is doubtful.
bool Session::isEstimated() const {
    if (!options_.estimate || !isMeasured(film_.iterations())) return false;
    const double seconds = report_.seconds,
                 atLeast = options_.timeSeconds.value_or(kEstimateSeconds);
    return seconds >= (report_.estimate.mape.doubt.empty() ? atLeast : 4.0 * atLeast);
}

Rendered Session::costs() {
    const Measured& mape = report_.estimate.mape;
    const AccuracyCost cost{options_.scene,     report_.method->name, film_.width(), film_.height(),
                            report_.iterations, report_.setupSeconds, errorNow(),    mape.doubt};
    if (!options_.common.json.empty()) writeJson(options_.common.json, costJson(cost));
    return finished(costTable(cost));
}

/// Layers that do not depend on iterations: features of the first visible surfaces, and those of
/// assets.
const LayeredImage& Session::still() {
    if (still_) return *still_;
    still_.emplace(film_.width(), film_.height());
    setFeatures(*still_, look_.features);
    for (const auto& asset : caches_.assets) {
        asset->draw(*still_, *stage_.scene, *stage_.camera, stage_.settings.crop, pool_);
    }
    if (options_.mattes.any()) addMattes(*still_);
    return *still_;
}

void Session::addMattes(LayeredImage& image) {
    const Stopwatch watch(report_.phaseSeconds["mattes"]);
    const Mattes mattes = renderMattes(*stage_.scene, *stage_.camera, stage_.settings.crop,
                                       stage_.settings.seed, pool_);
    if (options_.mattes.objects) addCryptomatte(image, mattes.objects);
    if (options_.mattes.materials) addCryptomatte(image, mattes.materials);
}

/// Names of all channels that the picture may have.
std::vector<std::string> Session::channelNames() {
    std::vector<std::string> names;
    const auto addRgb = [&](const std::string& layer) {
        for (const char* part : {".R", ".G", ".B"}) names.push_back(layer + part);
    };
    addRgb("variance");
    if (options_.transparentBackground) names.push_back("A");
    for (const auto& [name, plane] : still().channels()) names.push_back(name);
    for (const std::string& layer : stage_.layers.names()) addRgb(layer);
    if (options_.lightNoise) {
        for (const std::string& layer : lightCovarianceLayers(report_.lightGroups.size())) {
            addRgb(layer);
        }
    }
    if (!options_.techniques) return names;
    for (const std::string& label : report_.method->proposalLabels) addRgb("part." + label);
    const std::vector<std::string> ofTechniques =
        TechniqueFilm::channelNames(report_.limits.maxDepth);
    names.insert(names.end(), ofTechniques.begin(), ofTechniques.end());
    return names;
}

void Session::beginLiveView() {
    const std::vector<std::string>& layers = options_.displayLayers;
    const std::vector<std::string> all = layers.empty() ? layers : channelNames();
    live_.emplace(*options_.displayServer,
                  TevImage{pictureName(), film_.width(), film_.height(),
                           channelsOfLayers("--display-layers", layers, all)},
                  [this](const std::string& text) { progress_.warning(text); });
}

/// The image for the viewer; it may contain more channels than shown.
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
        image = shown(film_.sum(idlePool()));
    }
    live_->show(std::move(image), LiveView::Seconds(seconds));
}

/// --write-every: writes the current picture to the output.
void Session::refreshOutput() {
    if (const auto failure = refresh_->failure()) {
        progress_.warning("warning: " + *failure + " (the render goes on)");
    }
    if (!refresh_->due()) return;
    RenderReport now = report_;
    now.statistics = totals_.statistics;
    refresh_->begin([this, image = output(now, film_.sum(idlePool()))] {
        if (endingOf(options_.output) == ".exr") {
            ExrStyle style = options_.exr;
            style.compression = ExrCompression::None;  // only the final one is compressed
            writeExr(options_.output, image, style);
        } else {
            writeImage(options_.output, image, options_.png);
        }
    });
}

/// The image to be written.
LayeredImage Session::output(const RenderReport& report, const FilmSum& sum) {
    const bool layers =
        options_.output.empty() || endingOf(options_.output) == ".exr" || !options_.sheet.empty();
    LayeredImage image = composeImage(report, sum, layers ? &still() : nullptr);
    if (options_.blocks) {
        addPart(image, {inputs_, film_.width(), film_.height(), plan_, report_.firstBlock,
                        film_.finalState(pool_), totals_.seconds, totals_.statistics});
    }
    return image;
}

/// The pool for sums between iterations; null if this process makes pieces meanwhile.
const ThreadPool* Session::idlePool() const {
    return together_ ? nullptr : &pool_;
}

/// The current part for a checkpoint or --blocks.
Part Session::part() const {
    // An open block is not saved if the method learns in it or layers accumulate it.
    const bool withOpen = !maker_.blocksAreWhole();
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
    progress_.phase("saving the checkpoint", kBeingSaved);
    try {
        checkpoint_->finish(std::move(now));
    } catch (const std::exception& e) {
        failure_ = e.what();
    }
}

/// Compares with the reference. A picture that cannot be compared (because of an infinite pixel) is
/// kept.
void Session::measure() {
    if (!reference_) return;
    const Stopwatch watch(report_.phaseSeconds["compare"]);
    try {
        report_.error = reference_->compare(film_.image(idlePool()), pictureName());
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

/// The .png style with definite stops, also for `auto`. They are reported, so that the user can
/// give the next picture the same exposure.
PngStyle Session::fixedExposure(const LayeredImage& image) {
    PngStyle png = options_.png;
    if (endingOf(options_.output) != ".png" && options_.sheet.empty()) return png;
    if (!png.exposure) {
        // Rounded to hundredths, so that the printed number makes the same picture.
        png.exposure = std::round(png.stopsFor(image.rgb()) * 100.0) / 100.0;
        progress_.remark("--exposure auto: " + numberText(*png.exposure) + " stops");
    }
    report_.exposure = png.exposure;
    return png;
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
    report_.estimate = estimateError(sum, look_.meter, &pool_);
    warnIfBlack();
    report_.verify = maker_.verified();
    if (report_.techniques) {
        report_.techniqueCosts =
            techniqueCosts(sum, look_.meter, report_.statistics, double(report_.threads), &pool_);
    }

    progress_.phase("saving", kBeingSaved);
    if (live_) live_->showLast(shown(sum));
    image_ = output(report_, sum);
    const PngStyle png = fixedExposure(image_);
    {
        const Stopwatch watch(report_.phaseSeconds["save"]);
        if (refresh_) refresh_->wait();  // otherwise the older image could be written last
        if (!options_.output.empty()) writeImage(options_.output, image_, png, options_.exr);
        if (!options_.sheet.empty()) {
            // The sums of a part are not layers to show.
            const Canvas sheet =
                layerSheet(options_.blocks ? composeImage(report_, sum, &still()) : image_, png);
            writePngBytes(options_.sheet, sheet.width(), sheet.height(), sheet.bytes());
        }
    }
    if (!options_.common.json.empty()) {
        writeJson(options_.common.json, reportJson(report_));
    }
    if (live_) live_->leave();
}

/// A line about the saved picture, and the measured errors.
std::string Session::savedText() const {
    char line[256];
    std::snprintf(line, sizeof line,
                  "%d x %d pixels, %s, %llu iteration%s in %.3g s (setup %.3g s), %.4g rays%s\n",
                  film_.width(), film_.height(), report_.method->name.c_str(),
                  static_cast<unsigned long long>(report_.iterations),
                  report_.iterations == 1 ? "" : "s", report_.seconds, report_.setupSeconds,
                  double(report_.statistics.totalRays()),
                  report_.stopped == "interrupt" ? " (interrupted)" : "");
    std::string text = pictureName() + ": " + line;
    if (report_.error) {
        std::snprintf(line, sizeof line, "mae %.6g rmse %.6g mape %.6g relmse %.6g\n",
                      report_.error->mae, report_.error->rmse, report_.error->mape,
                      report_.error->relmse);
        text += line;
    }
    if (report_.techniques) text += techniqueTable(report_.techniqueCosts);
    if (report_.verify) {
        std::snprintf(
            line, sizeof line, "verify: largest difference of a weight %.3g over %llu paths\n",
            report_.verify->maxDifference, static_cast<unsigned long long>(report_.verify->paths));
        text += line;
    }
    return text;
}

/// Warns of a black picture. For a scene without light there was a warning already. After an
/// interrupt, nobody wants to wait for a diagnosis.
void Session::warnIfBlack() {
    const auto& mean = report_.mean.mean;
    const bool black = mean[0] == 0.0 && mean[1] == 0.0 && mean[2] == 0.0;
    if (!black || stage_.scene->lights().empty() || report_.stopped == "interrupt") return;
    progress_.phase("looking for light", kBeingSaved);
    report_.warnings.push_back(whyBlack(stage_, *report_.method, pool_));
    progress_.warning("warning: " + options_.scene + ": " + report_.warnings.back());
}

std::string Session::replayCommand(const std::string& replay) const {
    const std::string byName = report_.choice ? " " + report_.choice->byName() : "";
    return options_.commandLine + byName + " --replay " + replay;
}

void Session::warnAboutDefects() {
    const IterationStatistics& s = report_.statistics;
    if (s.invalidSamples > 0) {
        progress_.warning(
            "warning: " + std::to_string(s.invalidSamples) +
            " samples, or sums with them, were not finite and were left out; see one with: " +
            replayCommand(s.invalidReplays.at(0)));
    }
    if (report_.verify && !(report_.verify->maxDifference <= kVerifyTolerance)) {
        progress_.warning("warning: a weight differs from its full product by " +
                          std::to_string(report_.verify->maxDifference) +
                          "; see it with: " + replayCommand(report_.verify->replay));
    }
}

}  // namespace lacuna
