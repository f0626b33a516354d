// A loaded scene with what the command line says about it: the start of rendering and of replay.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libcore/bidir/integrator.h"
#include "libcore/methods/registry.h"
#include "libcore/scene/scene.h"
#include "render/effects.h"
#include "render/options.h"
#include "render/progress.h"

namespace lacuna {

struct Stage {
    std::vector<Effect> effects;
    Techniques techniques;  ///< the method's, as far as effects were not forced
    std::unique_ptr<Scene> scene;
    std::unique_ptr<Camera> camera;
    std::string cameraName;  ///< as asked for; empty: the first
    Camera::Lens lens;
    RenderSettings settings;  ///< limits, seed, crop (the whole film where none was asked for)
    double setupSeconds = 0.0;
    std::map<std::string, double> phaseSeconds;
    std::vector<std::string> warnings;
};

/// The file with the options' environment put into it. Throws InputError, UsageError.
SceneDescription describeScene(const RenderOptions& options);

/// The size of the whole picture: options, else extras, else by the camera. Throws InputError
/// without a camera, UsageError for an unknown one or an absurd size.
Camera::Film filmOf(const RenderOptions& options, const SceneDescription& scene);

/// The lens radius that options and extras ask for.
double lensRadius(const RenderOptions& options, const SceneDescription& scene);

/// Loads and builds. Warnings go to `progress` as well. Throws InputError, UsageError, RunError.
Stage loadStage(const RenderOptions& options, const MethodRow& method, const Settings& settings,
                const ThreadPool& pool, Progress& progress);

}  // namespace lacuna
