// The path space of a scene, as methods see it (path_space.h).
#pragma once

#include "libcore/bidir/close.h"
#include "libcore/bidir/path_space.h"
#include "libcore/bidir/walk.h"

namespace lacuna {

class ScenePaths final : public PathSpace {
  public:
    /// The walker must outlive it.
    explicit ScenePaths(const Walker& walker) : walker_(walker) {}

    void traceEye(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const override;
    Arrival arrival(Subpath light, Subpath eye, bool throughEye) const override;
    bool visible(const PathVertex& light, const PathVertex& eye, RayTally& tally) const override {
        return connected(walker_.scene(), light, eye, RayKind::Cache, tally);
    }
    float reach(const Vec3& origin, const Vec3& direction, RayTally& tally) const override;

  private:
    const Walker& walker_;
};

}  // namespace lacuna
