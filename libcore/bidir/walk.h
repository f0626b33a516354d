// Random walks from either end: the only place where subpaths are made. (theory.md, "Paths and measures")
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "libcore/base/rng.h"
#include "libcore/bidir/guides.h"
#include "libcore/bidir/method.h"
#include "libcore/bidir/path.h"
#include "libcore/scene/scene.h"

namespace lacuna {

struct WalkLimits {
    int maxDepth = 12;  ///< longest full path, in edges (1 = light seen directly), <= kMaxEdges
    /// First vertex index at which Russian roulette is played. The survival probability is a
    /// function of the vertex's material alone, so both walks know it. It is part of p(y) and p(z).
    int rouletteDepth = 3;
};

/// A subpath that is being traced: what its walk needs for the next step.
struct Walk {
    Side side;
    std::vector<PathVertex>* path;  ///< y_0 or z_0 at least
    Rng* rng;
    Vec3 origin, ng;  ///< of the next ray; ng: of the surface there, zero where there is none
    Vec3 direction;   ///< unit
    float pdfW;       ///< of the direction; at infinity: of the point on the disk
    Rgb throughput;   ///< that the ray carries
    /// Whether other pixels may go on along the walk. They may carry colours that it has lost, so
    /// it goes on when its throughput is black.
    bool lends = false;
};

class Walker final : public LightSampler {
  public:
    /// Scene and camera must outlive it.
    Walker(const Scene& scene, const Guides& guides, const Camera& camera, WalkLimits limits)
        : scene_(scene),
          guides_(guides),
          lights_(guides_.lights ? *guides_.lights : scene.lights()),
          camera_(camera),
          limits_(limits) {}
    Walker(const Scene& scene, const Camera& camera, WalkLimits limits)
        : Walker(scene, Guides{}, camera, limits) {}

    const Scene& scene() const { return scene_; }
    /// The scene's lights, or the guided ones.
    const Lights& lights() const { return lights_; }
    const WalkGuide* guide() const { return guides_.walks.get(); }
    const Camera& camera() const { return camera_; }
    const WalkLimits& limits() const { return limits_; }

    /// Replaces `out` by y_0 .. of one light subpath: at most maxDepth vertices, none where the
    /// scene has no light.
    void traceLight(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const;
    /// Replaces `out` by z_0 .. of one eye subpath through `raster`: at most maxDepth + 1 vertices,
    /// the last one Infinite where it left a scene with an environment.
    void traceEye(Vec2 raster, Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const;

    /// The first part of traceLight, for tracing several walks at once: makes y_0, and returns the
    /// walk from there. Empty where the subpath ends with y_0.
    std::optional<Walk> startLight(Rng& rng, std::vector<PathVertex>& out) const;
    /// Likewise for traceEye: makes z_0.
    Walk startEye(Vec2 raster, Rng& rng, std::vector<PathVertex>& out) const;
    /// The second part: traces all walks to their ends. Each becomes what it would be
    /// if traced alone.
    void finish(std::span<Walk> walks, RayTally& tally) const;

    bool sampleLight(Rng& rng, PathVertex& out) const override;
    Seen sampleSeenLight(const PathVertex& eye, Rng& rng, PathVertex& out) const override;
    double seenSamples(const PathVertex& light, const PathVertex& eye) const override;
    /// Makes y_0 on a light without an extent that was picked with probability `pmf`. False where
    /// the light is dark.
    bool placeLight(std::uint32_t light, double pmf, PathVertex& out) const;
    /// The BSDF's value at a surface vertex, and the densities (pdfW) that the two walks have there, guides included.
    /// `event` is that of the pair of directions (Bsdf::evaluate).
    BsdfEvaluation scattering(const PathVertex& v, const Vec3& toEye, const Vec3& toLight,
                              ScatterEvent event = ScatterEvent::Smooth) const {
        BsdfEvaluation e = v.bsdf.evaluate(toEye, toLight, event);
        if (v.region != kNone) guide()->mix(v.region, toEye, toLight, event, e);
        return e;
    }
    /// PathVertex::region of a surface vertex.
    std::uint32_t regionOf(const PathVertex& v) const {
        return guide() && v.bsdf.connectable() ? guide()->regionAt(WalkGuide::placeOf(v)) : kNone;
    }
    /// Probability of going on from the vertex: one where roulette is not played yet.
    float survivalAt(const PathVertex& v) const {
        return int(v.index) >= limits_.rouletteDepth ? v.survival : 1.0f;
    }
    /// z_0: a point on the lens.
    PathVertex sampleLens(Rng& rng) const;

  private:
    std::optional<LightPoint> sampleLightPoint(Rng& rng, PathVertex& out) const;
    bool setLightVertex(const LightPoint& point, PathVertex& out) const;
    static void setOut(Walk& walk, const Lights::Emission& emission);
    void finishAlone(Walk& walk, RayTally& tally) const;
    void finishTogether(std::span<Walk> walks, RayTally& tally) const;
    std::optional<Hit> nextHit(const Walk& walk, RayTally& tally) const;
    bool scatter(Walk& walk, const SurfacePoint& hit) const;
    std::optional<BsdfSample> sampleDirection(Side side, const PathVertex& v, Rng& rng) const;
    void addSurface(const SurfacePoint& point, const Vec3& direction, float pdfW,
                    const Rgb& throughput, std::vector<PathVertex>& out) const;

    const Scene& scene_;
    const Guides guides_;
    const Lights& lights_;
    const Camera& camera_;
    WalkLimits limits_;
};

}  // namespace lacuna
