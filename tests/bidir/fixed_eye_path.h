// A path space of one eye subpath, the same every time; nothing arrives and everything is visible
// unless a test says otherwise.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/bidir/method.h"
#include "libcore/material/albedo_tables.h"

namespace lacuna::test {

class FixedEyePath : public PathSpace {
  public:
    Subpath eye() const { return path_; }

    void traceEye(Rng&, RayTally&, std::vector<PathVertex>& out) const override { out = path_; }
    Arrival arrival(Subpath, Subpath, bool) const override { return {}; }
    bool visible(const PathVertex&, const PathVertex&, RayTally&) const override { return true; }
    float reach(const Vec3&, const Vec3&, RayTally&) const override { return 1.0f; }

  protected:
    FixedEyePath() : tables_(std::vector<float>{1.5f}) {}

    void addLens(Vec3 position) {
        PathVertex lens;
        lens.kind = VertexKind::Lens;
        lens.position = position;
        path_.push_back(lens);
    }
    /// Looks along +z.
    void addSurface(Vec3 position, const Bsdf::Parameters& parameters,
                    ScatterEvent event = ScatterEvent::Smooth) {
        PathVertex v;
        v.kind = VertexKind::Surface;
        v.index = std::uint16_t(path_.size());
        v.position = position;
        v.ng = {0, 0, 1};
        v.toPrevious = normalize(path_.back().position - position);
        v.bsdf = Bsdf(parameters, v.ng, v.ng, tables_);
        v.event = event;
        path_.push_back(v);
    }

  private:
    AlbedoTables tables_;
    std::vector<PathVertex> path_;
};

}  // namespace lacuna::test
