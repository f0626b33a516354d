// The scene of a render with its method: the starting point of rendering and replay.
#pragma once

#include "libcore/bidir/integrator.h"
#include "libcore/bidir/path_layers.h"
#include "libcore/tool/scene_stage.h"
#include "render/options.h"

namespace lacuna {

struct Stage : SceneStage {
    RenderSettings settings;  ///< limits, seed, crop (by default the whole film)
    double setupSeconds = 0.0;
    PathLayers layers;  ///< of light groups and expressions, as requested
};

/// Loads and builds the scene. Warnings go to `progress` as well. Throws InputError, UsageError,
/// RunError.
Stage loadStage(const RenderOptions& options, const MethodRow& method, const Settings& settings,
                const ThreadPool& pool, Progress& progress);

/// Replaces the method for which the stage was loaded by one that was chosen afterwards.
void useMethod(Stage& stage, const RenderOptions& options, const MethodRow& method,
               const Settings& settings);

}  // namespace lacuna
