// Random walks from either end: the only place where subpaths are made.
#pragma once

#include <vector>

#include "libcore/base/rng.h"
#include "libcore/bidir/method.h"
#include "libcore/bidir/path.h"
#include "libcore/scene/scene.h"

namespace lacuna {

struct WalkLimits {
    int maxDepth = 12;  ///< longest full path, in edges (1 = light seen directly), <= kMaxEdges
    /// First vertex index at which Russian roulette is played. The survival probability is a
    /// function of the vertex's material alone, so that both walks know it, and part of p(y) and
    /// p(z).
    int rouletteDepth = 3;
};

class Walker final : public LightSampler {
  public:
    Walker(const Scene& scene, const Camera& camera, WalkLimits limits)
        : scene_(scene), camera_(camera), limits_(limits) {}

    const Scene& scene() const { return scene_; }
    const Camera& camera() const { return camera_; }
    const WalkLimits& limits() const { return limits_; }

    /// Replaces `out` by y_0 .. of one light subpath: at most maxDepth vertices, none where the
    /// scene has no light.
    void traceLight(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const;
    /// Replaces `out` by z_0 .. of one eye subpath through `raster`: at most maxDepth + 1 vertices,
    /// the last one Infinite where it left a scene with an environment.
    void traceEye(Vec2 raster, Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const;

    bool sampleLight(Rng& rng, PathVertex& out) const override;
    /// z_0: a point on the lens.
    PathVertex sampleLens(Rng& rng) const;

  private:
    void goOn(Side side, Vec3 origin, Vec3 direction, float pdfW, Rgb throughput,
              std::size_t maxVertices, Rng& rng, RayTally& tally,
              std::vector<PathVertex>& out) const;
    void addSurface(const SurfacePoint& point, const Vec3& direction, float pdfW,
                    const Rgb& throughput, std::vector<PathVertex>& out) const;

    const Scene& scene_;
    const Camera& camera_;
    WalkLimits limits_;
};

}  // namespace lacuna
