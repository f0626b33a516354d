// A loaded scene with the options of the command line applied: the starting point of every tool
// that needs a scene.
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

/// Whether a tool needs a camera.
enum class LooksAt : std::uint8_t {
    Scene,   ///< only the scene; cameras are not needed
    Camera,  ///< the scene through the chosen camera
};

struct SceneStage {
    std::vector<Effect> effects;
    double tolerance = 0.0;
    Techniques techniques;  ///< the method's, except for forced effects
    std::unique_ptr<Scene> scene;
    std::unique_ptr<Camera> camera;  ///< null for LooksAt::Scene
    double aspect = 0.0;             ///< width over height, before rounding to pixels
    WalkLimits limits;               ///< from options, else extras, else defaults
    std::map<std::string, double> phaseSeconds;
    std::vector<std::string> warnings;

    /// The inputs, besides sceneInputs(), of a cache that depends on the camera: camera, aspect of
    /// the picture, lens, depths. Empty for LooksAt::Scene.
    Settings viewInputs;
};

/// The inputs of a cache of the scene, by name: the content of the scene's files and of the
/// environment, with its scale and angle, forced effects, and the tolerance. Reads the
/// environment's file; throws InputError if it cannot.
Settings sceneInputs(const SceneStage& stage);

/// Identifies the environment's map: the hash of the file, or "colour R G B". Throws InputError if
/// the file cannot be read.
std::string contentOf(const EnvironmentDescription& environment);

/// Loads the scene's file and applies the options' environment and shift. Throws InputError,
/// UsageError.
SceneDescription describeScene(const SceneOptions& options);

/// The size of the whole picture, from options, else extras, else the camera. Throws InputError if
/// there is no camera, UsageError for an unknown camera or an absurd size.
Camera::Film filmOf(const SceneOptions& options, const SceneDescription& scene);

/// The lens radius of the options, else of the extras.
double lensRadius(const SceneOptions& options, const SceneDescription& scene);

/// A scene's effects for a method.
struct SceneEffects {
    std::vector<Effect> rows;
    Techniques techniques;  ///< the method's, except for forced effects
    std::vector<std::string> warnings;
};
/// Applies --tolerance and --effect, which may change the scene and the lens radius, and returns
/// the resulting effects. `method` may be null. Throws UsageError for an effect that is unknown or
/// cannot be forced.
SceneEffects chooseEffects(const SceneOptions& options, SceneDescription& scene, double& lensRadius,
                           const MethodRow* method);

/// Applies the options to the result of describeScene() and builds the scene. `method` may be null.
/// Warnings go to `progress` as well. Throws InputError, UsageError, RunError.
SceneStage buildStage(SceneDescription description, const SceneOptions& options, LooksAt looksAt,
                      const MethodRow* method, const ThreadPool& pool, Progress& progress);

/// Replaces the stage's techniques by those of `method`, except for forced effects.
void useMethod(SceneStage& stage, const SceneOptions& options, const MethodRow& method);

/// describeScene() in the pool's threads and buildStage(), for tools without a method.
SceneStage loadScene(const SceneOptions& options, LooksAt looksAt, const ThreadPool& pool,
                     Progress& progress);

}  // namespace lacuna
