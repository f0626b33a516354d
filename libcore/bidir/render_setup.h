// The data that stay the same from the first iteration of a render to the last, and the data of
// one iteration.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

#include "libcore/base/parallel.h"
#include "libcore/bidir/film.h"
#include "libcore/bidir/method.h"
#include "libcore/bidir/mis.h"
#include "libcore/bidir/sampler.h"
#include "libcore/bidir/scene_paths.h"
#include "libcore/bidir/walk.h"
#include "libcore/specular/chain_seeds.h"
#include "libcore/specular/smooth_glass.h"

namespace lacuna {

/// How often techniques behind glass are tried in a view. For next event through glass and along known ways, 1 is the
/// most; for specular chains, 1 is the rate where nothing is known of the view. (theory.md, "Effort behind glass")
struct GlassEffort {
    double refractions = 1.0;
    double knownWays = 1.0;
    double chains = 1.0;
};

struct RenderSettings {
    WalkLimits limits;
    std::uint64_t seed = 1;
    PixelRect crop;                ///< inside the camera's film
    std::uint64_t lightPaths = 0;  ///< L; 0: one per pixel of the full film
    /// B: iterations of a block. Methods learn anew in every block.
    std::uint64_t blockIterations = BlockPlan::kEndless;
    Sampling sampling = Sampling::Independent;
    Guides guides = {};
    std::shared_ptr<const ChainSeeds> chainSeeds = {};    ///< of the scene; null: made where needed
    std::shared_ptr<const SmoothGlass> smoothGlass = {};  ///< likewise
    GlassEffort glassEffort = {};
    /// Leaves out the environment where the lens sees it: paths of one edge. (coverage_film.h)
    bool transparentBackground = false;
};

/// Shared by the passes; all references outlive the render.
struct RenderSetup {
    RenderSetup(const Scene& scene_, const Camera& camera_, Techniques techniques_,
                const RenderSettings& settings_, const ThreadPool& threads_)
        : scene(scene_),
          camera(camera_),
          techniques(techniques_),
          settings(settings_),
          threads(threads_),
          walker(scene_, guidesFor(scene_, techniques_, settings_.guides), camera_,
                 settings_.limits),
          sampler(settings_.sampling, settings_.seed),
          lightPaths(settings_.lightPaths ? settings_.lightPaths : filmPixels()) {}

    RenderSetup(const RenderSetup&) = delete;
    RenderSetup& operator=(const RenderSetup&) = delete;

    /// The guides, with lights for next event that draws all of a sky where no walk
    /// runs into lights.
    static Guides guidesFor(const Scene& scene, const Techniques& techniques, Guides guides) {
        const bool byNextEvent = techniques.connects && !techniques.hits && !guides.lights;
        if (byNextEvent && scene.lights().environment()) {
            guides.lights = std::make_shared<const Lights>(scene.lights().withoutHits());
        }
        return guides;
    }

    std::uint64_t filmPixels() const {
        return std::uint64_t(camera.film().width) * std::uint64_t(camera.film().height);
    }
    /// Row-major, as is cropIndex.
    std::uint32_t filmIndex(int x, int y) const {
        return std::uint32_t(y) * std::uint32_t(camera.film().width) + std::uint32_t(x);
    }
    std::uint32_t cropIndex(int x, int y) const {
        const PixelRect& crop = settings.crop;
        return std::uint32_t(y - crop.y0) * std::uint32_t(crop.width()) +
               std::uint32_t(x - crop.x0);
    }

    /// Starts the eye path of a pixel (x, y in the film). `rng` is the pixel's stream.
    Walk startEye(int x, int y, Rng& rng, std::vector<PathVertex>& out) const {
        const auto [jitterX, jitterY] = rng.evenPair();
        return walker.startEye({float(x) + jitterX, float(y) + jitterY}, rng, out);
    }

    const Scene& scene;
    const Camera& camera;
    const Techniques techniques;
    const RenderSettings settings;
    const ThreadPool& threads;
    const Walker walker;
    const Sampler sampler;
    const ScenePaths space{walker};
    const std::uint64_t lightPaths;  ///< L
};

/// The current iteration.
struct Iteration {
    std::uint32_t number;
    const Method& method;
    TechniqueCounts counts;  ///< frozen for it
    double mergeRadius;      ///< R; 0 where nothing is merged
    std::span<Rgb> pixels;   ///< of the crop: sums of contributions; empty in a warm-up
    IterationStatistics& statistics;
    const std::atomic<bool>& cancel;
};

}  // namespace lacuna
