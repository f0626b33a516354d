// Where a chain of mirrors and smooth glass may begin: all triangles that have such an event.
#pragma once

#include <array>
#include <vector>

#include "libcore/base/discrete.h"
#include "libcore/base/rng.h"
#include "libcore/scene/scene.h"

namespace lacuna {

class SpecularTriangles {
  public:
    /// Of all instances.
    explicit SpecularTriangles(const Scene& scene);

    bool empty() const { return byArea_.empty(); }
    /// A point, evenly over all of their area. Not to be called when empty().
    Vec3 samplePoint(Rng& rng) const;

  private:
    std::vector<std::array<Vec3, 3>> triangles_;
    DiscreteDistribution byArea_;
};

}  // namespace lacuna
