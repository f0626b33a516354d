#include "render/stage.h"

#include <chrono>

#include "libcore/base/error.h"
#include "libcore/base/stopwatch.h"
#include "libcore/methods/glass_effort.h"
#include "render/freed_memory.h"

namespace lacuna {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

PixelRect chooseCrop(const RenderOptions& options, Camera::Film film) {
    if (!options.crop) return {0, film.width, 0, film.height};
    if (options.crop->x1 > film.width || options.crop->y1 > film.height) {
        throw UsageError("--crop: expected a part of " + std::to_string(film.width) + " x " +
                         std::to_string(film.height) + " pixels, found " + options.cropText);
    }
    return *options.crop;
}

}  // namespace

Stage loadStage(const RenderOptions& options, const MethodRow& method, const Settings& settings,
                const ThreadPool& pool, Progress& progress) {
    const Clock::time_point start = Clock::now();
    progress.phase("loading");
    SceneDescription description;
    pool.run([&] { description = describeScene(options); });
    const double loadSeconds = secondsSince(start);
    returnFreedMemory();  // the file's bytes: Embree's hierarchy does not come from the same heap
    // Everything that may reject the command line comes before the long work.
    const PixelRect crop = chooseCrop(options, filmOf(options, description));

    const MethodRow row = asSet(method, settings);
    Stage stage{buildStage(std::move(description), options, LooksAt::Camera, &row, pool, progress),
                {},
                0.0,
                {}};
    stage.layers = PathLayers(*stage.scene, options.lightGroups, options.layers);
    if (method.biased) {
        stage.warnings.push_back("method " + method.name +
                                 " is BIASED: an experiment of a paper (" + method.reference +
                                 "), its picture is wrong on purpose");
        progress.warning("warning: " + options.scene + ": " + stage.warnings.back());
    }
    stage.settings.limits = stage.limits;
    stage.settings.seed = options.common.seed;
    stage.settings.crop = crop;
    stage.settings.sampling = options.sampling;
    stage.settings.transparentBackground = options.transparentBackground;
    stage.settings.lightPaths = lightPathsOf(settings);
    if (stage.techniques.askForWays()) {
        const Stopwatch phase(stage.phaseSeconds["chains"]);
        stage.settings.chainSeeds = std::make_shared<const ChainSeeds>(*stage.scene, pool);
    }
    if (stage.techniques.refract()) {
        const Stopwatch phase(stage.phaseSeconds["glass"]);
        stage.settings.smoothGlass = std::make_shared<const SmoothGlass>(*stage.scene);
    }
    if (stage.techniques.refract() || stage.techniques.askForWays()) {
        const Stopwatch phase(stage.phaseSeconds["effort"]);
        stage.settings.glassEffort =
            glassEffortFor(*stage.scene, *stage.camera, stage.techniques, stage.settings, pool);
    }
    stage.phaseSeconds["load"] = loadSeconds;
    stage.setupSeconds = secondsSince(start);
    return stage;
}

void useMethod(Stage& stage, const RenderOptions& options, const MethodRow& method,
               const Settings& settings) {
    useMethod(static_cast<SceneStage&>(stage), options, asSet(method, settings));
    stage.settings.lightPaths = lightPathsOf(settings);
    stage.settings.sampling = options.sampling;
}

}  // namespace lacuna
