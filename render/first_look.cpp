#include "render/first_look.h"

#include "libcore/base/stopwatch.h"
#include "render/grace.h"

namespace lacuna {
namespace {

FeatureLayers featuresOf(Stage& stage, const ThreadPool& pool,
                         const std::atomic<bool>& interrupted) {
    const Stopwatch watch(stage.setupSeconds), phase(stage.phaseSeconds["features"]);
    std::atomic<bool> over = false;
    const Grace grace(interrupted, over);
    return renderFeatures(*stage.scene, *stage.camera, stage.settings.crop, stage.settings.seed,
                          pool, over);
}

}  // namespace

FirstLook::FirstLook(Stage& stage, const ThreadPool& pool, const std::atomic<bool>& interrupted)
    : features(featuresOf(stage, pool, interrupted)), meter(features) {}

}  // namespace lacuna
