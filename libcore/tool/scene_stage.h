// A loaded scene with what the command line says about it: where every tool that needs one begins.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libcore/base/parallel.h"
#include "libcore/bidir/walk.h"
#include "libcore/methods/registry.h"
#include "libcore/scene/scene.h"
#include "libcore/tool/effects.h"
#include "libcore/tool/progress.h"
#include "libcore/tool/scene_options.h"

namespace lacuna {

/// What a tool looks at.
enum class LooksAt : std::uint8_t {
    Scene,   ///< the scene alone: cameras are not asked for
    Camera,  ///< through the chosen camera
};

struct SceneStage {
    std::vector<Effect> effects;
    double tolerance = 0.0;
    Techniques techniques;  ///< the method's, as far as effects were not forced
    std::unique_ptr<Scene> scene;
    std::unique_ptr<Camera> camera;  ///< null where only the scene is looked at
    double aspect = 0.0;             ///< of the picture, before its sides are rounded to pixels
    WalkLimits limits;               ///< of the options, else the scene's extras, else by default
    std::map<std::string, double> phaseSeconds;
    std::vector<std::string> warnings;

    /// What a cache that is made through the camera depends on besides sceneInputs():
    /// camera, shape of the picture, lens, depths. Empty where only the scene is looked at.
    Settings viewInputs;
};

/// What a cache of the scene is made of, by name: the content of the scene's files and of the
/// environment, with its scale and angle, effects that are forced, the tolerance. Reads the
/// environment's file; throws InputError if it cannot.
Settings sceneInputs(const SceneStage& stage);

/// What its map is: the hash of the file, or "colour R G B". Throws InputError if it cannot be read.
std::string contentOf(const EnvironmentDescription& environment);

/// The file with the options' environment and shift put into it. Throws InputError, UsageError.
SceneDescription describeScene(const SceneOptions& options);

/// The size of the whole picture: options, else extras, else by the camera. Throws InputError
/// without a camera, UsageError for an unknown one or an absurd size.
Camera::Film filmOf(const SceneOptions& options, const SceneDescription& scene);

/// The lens radius that options and extras ask for.
double lensRadius(const SceneOptions& options, const SceneDescription& scene);

/// A scene's effects as a method renders them.
struct SceneEffects {
    std::vector<Effect> rows;
    Techniques techniques;  ///< the method's, as far as effects were not forced
    std::vector<std::string> warnings;
};
/// After --tolerance and --effect, which change the scene and the lens radius. `method` may be
/// null. Throws UsageError for an effect that is unknown or cannot be forced.
SceneEffects chooseEffects(const SceneOptions& options, SceneDescription& scene, double& lensRadius,
                           const MethodRow* method);

/// Applies the options to what describeScene() gave, and builds. `method` may be null. Warnings go
/// to `progress` as well. Throws InputError, UsageError, RunError.
SceneStage buildStage(SceneDescription description, const SceneOptions& options, LooksAt looksAt,
                      const MethodRow* method, const ThreadPool& pool, Progress& progress);

/// Puts the techniques of `method`, as far as effects were not forced, in place of those that the
/// stage was built with.
void useMethod(SceneStage& stage, const SceneOptions& options, const MethodRow& method);

/// describeScene() in the pool's threads and buildStage(), for tools without a method.
SceneStage loadScene(const SceneOptions& options, LooksAt looksAt, const ThreadPool& pool,
                     Progress& progress);

}  // namespace lacuna
