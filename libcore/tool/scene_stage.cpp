#include "libcore/tool/scene_stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"
#include "libcore/base/number_text.h"
#include "libcore/bidir/full_path.h"
#include "libcore/gltf/gltf.h"
#include "libcore/tool/tolerance.h"

namespace lacuna {
namespace {

constexpr int kDefaultWidth = 1280;
constexpr double kDefaultAspect = 16.0 / 9.0;  // for cameras without an aspect

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

const CameraDescription& chosenCamera(const SceneDescription& scene, const std::string& name) {
    requireCamera(scene);
    std::string names;
    for (const CameraDescription& c : scene.cameras) {
        if (name.empty() || c.name == name) return c;
        names += (names.empty() ? "'" : ", '") + c.name + "'";
    }
    throw UsageError("--camera: expected one of " + names + ", found '" + name + "'");
}

/// The aspect of both options, else of the extras if they name both sides, else of the camera.
double chooseAspect(const SceneOptions& options, const SceneDescription& scene,
                    const CameraDescription& camera) {
    if (options.width && options.height) return double(*options.width) / double(*options.height);
    if (scene.width && scene.height) return double(*scene.width) / double(*scene.height);
    return camera.aspectRatio > 0.0 ? camera.aspectRatio : kDefaultAspect;
}

/// The sides are those of the options, else those of the extras, else the width is 1280. A single
/// side determines the other by the aspect. Then both are scaled.
Camera::Film chooseFilm(const SceneOptions& options, const SceneDescription& scene,
                        const CameraDescription& camera) {
    const double aspect = chooseAspect(options, scene, camera);
    std::optional<std::int64_t> width = options.width, height = options.height;
    if (!width && !height) {
        width = scene.width;
        height = scene.height;
    }
    // Clamped, so that extreme aspects end in requireSaneFilm and not in an overflow.
    const auto side = [](double pixels) {
        return std::int64_t(std::clamp(std::round(pixels), 1.0, 1e9));
    };
    if (!width) width = height ? side(double(*height) * aspect) : kDefaultWidth;
    if (!height) height = side(double(*width) / aspect);
    const auto scaled = [&](std::int64_t pixels) { return side(double(pixels) * options.scale); };
    width = scaled(*width);
    height = scaled(*height);
    requireSaneFilm(*width, *height);
    return {int(*width), int(*height)};
}

/// The warning for a scene without light. Blender leaves lights out by default.
std::string noLightText(const Scene& scene) {
    std::string text = "no light in the scene: the picture is black";
    if (scene.lights().size() > 0) {
        text += " (its lights, " + std::to_string(scene.lights().size()) + ", have no power)";
    } else if (scene.description().fromBlender) {
        text +=
            " (Blender exports points, spots and suns only with Include > Punctual Lights on, area "
            "lights and the world never)";
    }
    return text;
}

Camera::Lens chooseLens(const SceneOptions& options, const SceneDescription& scene) {
    Camera::Lens lens;
    lens.radius = float(lensRadius(options, scene));
    const std::optional<double> focus = options.focus ? options.focus : scene.focus;
    lens.focus = float(focus.value_or(0.0));
    if (lens.radius > 0.0f && !(lens.focus > 0.0f && std::isfinite(lens.focus))) {
        throw UsageError(
            "--focus: expected the distance in focus, found none; add --focus D or --aperture 0");
    }
    return lens;
}

/// `camera` is identified by its position in the file, because names need not differ.
Settings viewInputsOf(const SceneDescription& scene, const CameraDescription& camera, double aspect,
                      Camera::Lens lens, const WalkLimits& limits) {
    Settings inputs;
    inputs["camera"] = std::to_string(&camera - scene.cameras.data() + 1) +
                       (camera.name.empty() ? "" : " " + camera.name);
    inputs["aspect"] = numberText(aspect);
    inputs["lens"] = lens.radius > 0.0f ? "radius " + numberText(double(lens.radius)) + " focus " +
                                              numberText(double(lens.focus))
                                        : "pinhole";
    if (camera.shift != std::array<double, 2>{}) {
        inputs["lens"] +=
            " shift " + numberText(camera.shift[0]) + " " + numberText(camera.shift[1]);
    }
    inputs["max depth"] = std::to_string(limits.maxDepth);
    inputs["roulette depth"] = std::to_string(limits.rouletteDepth);
    return inputs;
}

}  // namespace

Settings sceneInputs(const SceneStage& stage) {
    const SceneDescription& scene = stage.scene->description();
    Settings inputs{{"scene", scene.contentHash}, {"tolerance", numberText(stage.tolerance)}};
    inputs["lamp units"] = nameOf(scene.lampUnits);
    inputs["environment"] = "none";
    if (scene.environment) {
        inputs["environment"] = contentOf(*scene.environment);
        inputs["environment scale"] = numberText(scene.environment->scale);
        inputs["environment angle"] = numberText(scene.environment->rotationDegrees);
    }
    std::string forced;
    for (const Effect& e : stage.effects) {
        if (!e.forced || !e.ofScene) continue;
        forced += (forced.empty() ? "" : " ") + e.name + (e.simulated ? "=on" : "=off");
    }
    inputs["effects"] = forced.empty() ? "as the scene calls for" : forced;
    return inputs;
}

std::string contentOf(const EnvironmentDescription& environment) {
    if (!environment.colour) return hashOfFile(environment.file);
    const Rgb& c = *environment.colour;
    return "colour " + numberText(double(c.r)) + " " + numberText(double(c.g)) + " " +
           numberText(double(c.b));
}

SceneDescription describeScene(const SceneOptions& options) {
    SceneDescription scene = options.sceneBytes
                                 ? loadGltf(options.scene, *options.sceneBytes, options.units)
                                 : loadGltf(options.scene, options.units);
    if (options.shift) {
        for (CameraDescription& camera : scene.cameras) camera.shift = *options.shift;
    }
    if (options.environmentColour) {
        scene.environment = EnvironmentDescription{.file = {}, .colour = options.environmentColour};
    }
    if (!options.environment.empty()) {
        scene.environment = EnvironmentDescription{options.environment, 1.0, 0.0};
    }
    if (!scene.environment && (options.environmentRotation || options.environmentScale)) {
        throw UsageError(
            "--env-rotate, --env-scale: expected an environment, found none in the scene; add "
            "--env FILE or --env-colour R,G,B");
    }
    if (options.environmentRotation) {
        scene.environment->rotationDegrees = *options.environmentRotation;
    }
    if (options.environmentScale) scene.environment->scale = *options.environmentScale;
    return scene;
}

Camera::Film filmOf(const SceneOptions& options, const SceneDescription& scene) {
    return chooseFilm(options, scene, chosenCamera(scene, options.camera));
}

double lensRadius(const SceneOptions& options, const SceneDescription& scene) {
    return options.aperture ? *options.aperture : scene.aperture.value_or(0.0);
}

SceneEffects chooseEffects(const SceneOptions& options, SceneDescription& scene, double& radius,
                           const MethodRow* method) {
    SceneEffects effects;
    effects.rows = effectsWithin(options.tolerance, scene, radius, method, effects.warnings);
    if (method) effects.techniques = method->techniques;
    for (std::string& text :
         forceEffects(options.effectSwitches,
                      {scene, radius, method ? &effects.techniques : nullptr}, effects.rows)) {
        effects.warnings.push_back(std::move(text));
    }
    return effects;
}

SceneStage buildStage(SceneDescription description, const SceneOptions& options, LooksAt looksAt,
                      const MethodRow* method, const ThreadPool& pool, Progress& progress) {
    SceneStage stage;
    stage.phaseSeconds = description.phaseSeconds;
    const auto warn = [&](const std::string& text) {
        stage.warnings.push_back(text);
        progress.warning("warning: " + options.scene + ": " + text);
    };
    for (const std::string& text : description.warnings) warn(text);

    // Everything that may reject the command line comes before the long work.
    const bool looks = looksAt == LooksAt::Camera;
    const Camera::Film film = looks ? filmOf(options, description) : Camera::Film{};
    Camera::Lens lens = looks ? chooseLens(options, description) : Camera::Lens{};
    double radius = looks ? double(lens.radius) : lensRadius(options, description);
    SceneEffects effects = chooseEffects(options, description, radius, method);
    for (const std::string& text : effects.warnings) warn(text);
    stage.effects = std::move(effects.rows);
    stage.techniques = effects.techniques;
    stage.tolerance = options.tolerance;
    lens.radius = float(radius);
    WalkLimits& limits = stage.limits;
    if (options.maxDepth) {
        limits.maxDepth = int(*options.maxDepth);
    } else if (description.maxDepth) {
        limits.maxDepth = std::min(*description.maxDepth, kMaxEdges);
        if (limits.maxDepth < *description.maxDepth) {
            warn("max_depth " + std::to_string(*description.maxDepth) + " is rendered as " +
                 std::to_string(kMaxEdges) + ", the longest path there is");
        }
    }
    if (options.rouletteDepth) limits.rouletteDepth = int(*options.rouletteDepth);

    if (looks) {
        const CameraDescription& camera = chosenCamera(description, options.camera);
        stage.aspect = chooseAspect(options, description, camera);
        stage.viewInputs = viewInputsOf(description, camera, stage.aspect, lens, limits);
    }

    progress.phase("building");
    const Clock::time_point building = Clock::now();
    stage.scene = std::make_unique<Scene>(std::move(description), pool);
    if (looks) {
        stage.camera =
            std::make_unique<Camera>(stage.scene->makeCamera(options.camera, film, lens));
    }
    stage.phaseSeconds["build"] = secondsSince(building);
    if (stage.scene->lights().empty()) warn(noLightText(*stage.scene));
    return stage;
}

void useMethod(SceneStage& stage, const SceneOptions& options, const MethodRow& method) {
    std::erase_if(stage.effects, [](const Effect& e) { return !e.ofScene; });
    std::vector<Effect> rows = techniqueEffects(method, stage.scene->description(), stage.effects);
    std::vector<EffectSwitch> switches = options.effectSwitches;
    std::erase_if(switches, [&](const EffectSwitch& s) {
        return std::ranges::find(rows, s.name, &Effect::name) == rows.end();
    });
    stage.techniques = method.techniques;
    // Switches of techniques do not change the scene.
    SceneDescription untouched;
    double noLens = 0.0;
    forceEffects(switches, {untouched, noLens, &stage.techniques}, rows);
    stage.effects.insert(stage.effects.end(), rows.begin(), rows.end());
}

SceneStage loadScene(const SceneOptions& options, LooksAt looksAt, const ThreadPool& pool,
                     Progress& progress) {
    progress.phase("loading");
    SceneDescription description;
    pool.run([&] { description = describeScene(options); });
    return buildStage(std::move(description), options, looksAt, nullptr, pool, progress);
}

}  // namespace lacuna
