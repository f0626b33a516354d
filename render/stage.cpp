#include "render/stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/gltf/gltf.h"
#include "render/tolerance.h"

namespace lacuna {
namespace {

constexpr int kDefaultWidth = 1280;
constexpr double kDefaultAspect = 16.0 / 9.0;  // for cameras that state none

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

/// The extras' aspect where they name both sides, else the camera's.
double chooseAspect(const SceneDescription& scene, const CameraDescription& camera) {
    if (scene.width && scene.height) return double(*scene.width) / double(*scene.height);
    return camera.aspectRatio > 0.0 ? camera.aspectRatio : kDefaultAspect;
}

/// The options' sides; without any the extras'; without those 1280 wide. One side alone is given
/// the other by the aspect.
Camera::Film chooseFilm(const RenderOptions& options, const SceneDescription& scene,
                        const CameraDescription& camera) {
    const double aspect = chooseAspect(scene, camera);
    std::optional<std::int64_t> width = options.width, height = options.height;
    if (!width && !height) {
        width = scene.width;
        height = scene.height;
    }
    // Far-fetched aspects end in requireSaneFilm, not in a conversion that overflows.
    const auto side = [](double pixels) {
        return std::int64_t(std::clamp(std::round(pixels), 1.0, 1e9));
    };
    if (!width) width = height ? side(double(*height) * aspect) : kDefaultWidth;
    if (!height) height = side(double(*width) / aspect);
    requireSaneFilm(*width, *height);
    return {int(*width), int(*height)};
}

PixelRect chooseCrop(const RenderOptions& options, Camera::Film film) {
    if (!options.crop) return {0, film.width, 0, film.height};
    if (options.crop->x1 > film.width || options.crop->y1 > film.height) {
        throw UsageError("--crop: expected a part of " + std::to_string(film.width) + " x " +
                         std::to_string(film.height) + " pixels, found " + options.cropText);
    }
    return *options.crop;
}

/// Of a scene without light. Blender leaves lights out unasked.
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

Camera::Lens chooseLens(const RenderOptions& options, const SceneDescription& scene) {
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

}  // namespace

SceneDescription describeScene(const RenderOptions& options) {
    SceneDescription scene = loadGltf(options.scene);
    if (!options.environment.empty()) {
        scene.environment = EnvironmentDescription{options.environment, 1.0, 0.0};
    }
    if (!scene.environment && (options.environmentRotation || options.environmentScale)) {
        throw UsageError(
            "--env-rotate, --env-scale: expected an environment, found none in the scene; add "
            "--env FILE");
    }
    if (options.environmentRotation) {
        scene.environment->rotationDegrees = *options.environmentRotation;
    }
    if (options.environmentScale) scene.environment->scale = *options.environmentScale;
    return scene;
}

Camera::Film filmOf(const RenderOptions& options, const SceneDescription& scene) {
    return chooseFilm(options, scene, chosenCamera(scene, options.camera));
}

double lensRadius(const RenderOptions& options, const SceneDescription& scene) {
    return options.aperture ? *options.aperture : scene.aperture.value_or(0.0);
}

Stage loadStage(const RenderOptions& options, const MethodRow& method, const Settings& settings,
                const ThreadPool& pool, Progress& progress) {
    const Clock::time_point start = Clock::now();
    Stage stage;
    progress.phase("loading");
    SceneDescription description;
    pool.run([&] { description = describeScene(options); });
    stage.phaseSeconds = description.phaseSeconds;
    stage.phaseSeconds["load"] = secondsSince(start);
    const auto warn = [&](const std::string& text) {
        stage.warnings.push_back(text);
        progress.warning("warning: " + options.scene + ": " + text);
    };
    for (const std::string& text : description.warnings) warn(text);
    if (method.biased) {
        warn("method " + method.name + " is BIASED: an experiment of a paper (" + method.reference +
             "), its picture is wrong on purpose");
    }

    // Everything that may refuse the command line comes before the long work.
    const Camera::Film film = filmOf(options, description);
    Camera::Lens lens = chooseLens(options, description);
    double radius = lens.radius;
    std::vector<std::string> leftOut;
    stage.effects = effectsWithin(options.tolerance, description, radius, &method, leftOut);
    for (const std::string& text : leftOut) warn(text);
    stage.techniques = method.techniques;
    for (const std::string& text : forceEffects(
             options.effectSwitches, {description, radius, &stage.techniques}, stage.effects)) {
        warn(text);
    }
    lens.radius = float(radius);
    WalkLimits& limits = stage.settings.limits;
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
    stage.settings.seed = options.common.seed;
    stage.settings.crop = chooseCrop(options, film);
    stage.settings.lightPaths = lightPathsOf(settings);

    progress.phase("building");
    const Clock::time_point building = Clock::now();
    stage.scene = std::make_unique<Scene>(std::move(description), pool);
    stage.cameraName = options.camera;
    stage.lens = lens;
    stage.camera = std::make_unique<Camera>(stage.scene->makeCamera(options.camera, film, lens));
    stage.phaseSeconds["build"] = secondsSince(building);
    if (stage.scene->lights().empty()) warn(noLightText(*stage.scene));
    stage.setupSeconds = secondsSince(start);
    return stage;
}

}  // namespace lacuna
