#include "render/black_picture.h"

#include <algorithm>
#include <cmath>

#include "libcore/bidir/integrator.h"
#include "libcore/bidir/small_film.h"

namespace lacuna {
namespace {

constexpr int kPaths = 4096;  // subpaths of each kind, and eye paths of one small render
constexpr int kIterations = 16;
constexpr int kAmpleDepth = WalkLimits{}.maxDepth;

/// Whether bpt finds light on paths of up to `maxDepth` edges.
bool bptFindsLight(const Stage& stage, const SmallFilm& small, int maxDepth,
                   const ThreadPool& pool) {
    const MethodRow& row = findMethod("bpt");
    const std::unique_ptr<Method> method = row.create(resolve(row, {}));
    RenderSettings settings = stage.settings;
    settings.limits.maxDepth = maxDepth;
    settings.crop = small.crop;
    settings.lightPaths = kPaths;
    const Camera camera = stage.camera->withFilm(small.film);
    BidirIntegrator integrator(*stage.scene, camera, row.techniques, *method, settings, pool);
    std::vector<Rgb> pixels(std::size_t(small.crop.width()) * std::size_t(small.crop.height()));
    const std::atomic<bool> never{false};
    IterationStatistics ignored;
    for (std::uint32_t i = 0; i < kIterations; ++i) {
        integrator.render(i, pixels, never, ignored);
        if (!std::ranges::all_of(pixels, isBlack)) return true;
    }
    return false;
}

/// Counts of what subpaths in the scene meet; kPaths of each kind.
struct Encounters {
    int lit = 0;                ///< light subpaths that begin with power
    int lightMeets = 0;         ///< those that meet a surface
    int lightRough = 0;         ///< those whose first surface is rough or diffuse
    int eyeMeets = 0;           ///< eye subpaths that meet a surface
    int eyeRough = 0;           ///< those whose first surface is rough or diffuse
    int front = 0, behind = 0;  ///< lamps that eye subpaths hit, by their side
};

Encounters meet(const Stage& stage, const SmallFilm& small) {
    Encounters e;
    const Scene& scene = *stage.scene;
    WalkLimits limits = stage.settings.limits;
    limits.maxDepth = std::max(limits.maxDepth, kAmpleDepth);
    const Camera camera = stage.camera->withFilm(small.film);
    const Walker walker(scene, camera, limits);
    RayTally tally;  // not part of any render
    std::vector<PathVertex> path;
    const PixelRect& crop = small.crop;
    for (int i = 0; i < kPaths; ++i) {
        Rng light(stage.settings.seed, 0, StreamKind::LightPath, std::uint64_t(i));
        walker.traceLight(light, tally, path);
        e.lit += !path.empty() && !isBlack(path[0].throughput);
        e.lightMeets += path.size() > 1;
        e.lightRough += path.size() > 1 && path[1].connectable();

        Rng eye(stage.settings.seed, 0, StreamKind::EyePath, std::uint64_t(i));
        const Vec2 raster{float(crop.x0) + eye.uniform() * float(crop.width()),
                          float(crop.y0) + eye.uniform() * float(crop.height())};
        walker.traceEye(raster, eye, tally, path);
        const bool meets = path.size() > 1 && path[1].kind == VertexKind::Surface;
        e.eyeMeets += meets;
        e.eyeRough += meets && path[1].connectable();
        for (const PathVertex& v : path) {
            if (v.kind != VertexKind::Surface || v.light == kNone) continue;
            const bool shines = scene.lights().profile(v.light, v.ng, v.toPrevious) > 0.0f;
            ++(shines ? e.front : e.behind);
        }
    }
    return e;
}

bool anyHittable(const Lights& lights) {
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (isHittable(lights.kind(i)) && lights.pmf(i) > 0.0) return true;
    }
    return false;
}

/// Why the method cannot use the paths on which bpt finds light.
std::string whyNotByThisMethod(const MethodRow& method, const Encounters& e, bool hittable) {
    const std::string bpt = "; a test with bpt finds light here";
    const Techniques& t = method.techniques;
    if (t.splats && !t.connects && e.eyeRough == 0) {
        return method.name +
               " joins surfaces with the camera alone, and the camera sees only mirrors and smooth "
               "glass" +
               bpt;
    }
    if (t.connects && !t.splats && !hittable && e.lightRough == 0) {
        return "the lamps have no size to be hit, and their light meets mirrors or smooth glass "
               "first, over which " +
               method.name + " finds few ways" + bpt;
    }
    return method.name + " found no light; a test with bpt found some: use bpt, or render longer";
}

std::string paths(int n) {
    return std::to_string(n) + " of " + std::to_string(kPaths);
}

/// The causes in the scene if bpt finds no light either.
std::string whyNotAtAll(const Encounters& e, bool hittable) {
    if (e.lit == 0) return "the emission of every lamp is black, which is no light";
    std::string text;
    const auto add = [&](bool holds, const std::string& cause) {
        if (holds) text += (text.empty() ? "" : "; ") + cause;
    };
    add(e.eyeMeets == 0, "the camera sees no surface");
    add(e.lightMeets == 0, "no light meets a surface: do the lamps face away?");
    add(e.front == 0 && e.behind > 0,
        "every lamp that eye paths ran into was seen from behind, where it does not shine: turn it "
        "round or make its material doubleSided");
    add(!hittable && e.lightMeets > 0 && e.lightRough == 0 && e.eyeMeets > 0 && e.eyeRough == 0,
        "the lamps have no size, and mirrors or smooth glass are in front of them and of the "
        "camera: ways over more than six in a row are not found; use vcm if anything else lies "
        "between them, or small emissive spheres, or make the glass a little rough");
    if (!text.empty()) return text;
    return "light meets surfaces (" + paths(e.lightMeets) +
           " light paths) and the camera sees some (" + paths(e.eyeMeets) +
           " eye paths), but bpt joined none of them in a test: is the light "
           "shut in?";
}

std::string cause(const Stage& stage, const MethodRow& method, const ThreadPool& pool) {
    const SmallFilm small(stage.camera->film(), stage.settings.crop, kPaths);
    const Encounters encounters = meet(stage, small);
    const bool hittable = anyHittable(stage.scene->lights());
    const int depth = stage.settings.limits.maxDepth;
    if (bptFindsLight(stage, small, depth, pool)) {
        return whyNotByThisMethod(method, encounters, hittable);
    }
    if (depth < kAmpleDepth && bptFindsLight(stage, small, kAmpleDepth, pool)) {
        return "no light was found on paths of up to " + std::to_string(depth) +
               (depth == 1 ? " edge" : " edges") + ", a test with " + std::to_string(kAmpleDepth) +
               " found some: raise --max-depth";
    }
    return whyNotAtAll(encounters, hittable);
}

}  // namespace

std::string whyBlack(const Stage& stage, const MethodRow& method, const ThreadPool& pool) {
    return "every pixel is black: " + cause(stage, method, pool) +
           " (more under 'Why is my picture black?' in render/README.md)";
}

}  // namespace lacuna
