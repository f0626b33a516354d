// The scene of a render with its method: the start of rendering and of replay.
#pragma once

#include "libcore/bidir/integrator.h"
#include "libcore/bidir/path_layers.h"
#include "libcore/tool/scene_stage.h"
#include "render/options.h"

namespace lacuna {

struct Stage : SceneStage {
    RenderSettings settings;  ///< limits, seed, crop (the whole film where none was asked for)
    double setupSeconds = 0.0;
    PathLayers layers;  ///< of light groups and expressions, as far as they are asked for
};

/// Loads and builds. Warnings go to `progress` as well. Throws InputError, UsageError, RunError.
Stage loadStage(const RenderOptions& options, const MethodRow& method, const Settings& settings,
                const ThreadPool& pool, Progress& progress);

/// Puts a method that was chosen afterwards in the place of that which the stage was loaded for.
void useMethod(Stage& stage, const RenderOptions& options, const MethodRow& method,
               const Settings& settings);

}  // namespace lacuna
