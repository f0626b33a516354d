#include "render/first_look.h"

#include "libcore/base/stopwatch.h"

namespace lacuna {
namespace {

FeatureLayers featuresOf(Stage& stage, const ThreadPool& pool) {
    const Stopwatch watch(stage.phaseSeconds["features"]);
    return renderFeatures(*stage.scene, *stage.camera, stage.settings.crop, stage.settings.seed,
                          pool);
}

}  // namespace

FirstLook::FirstLook(Stage& stage, const ThreadPool& pool)
    : features(featuresOf(stage, pool)), meter(features) {}

}  // namespace lacuna
