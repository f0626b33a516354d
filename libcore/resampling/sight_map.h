// How far one sees from a point, by direction. (theory.md, "Nodes")
#pragma once

#include <cstddef>
#include <vector>

#include "libcore/bidir/method.h"

namespace lacuna {

/// Distances to the first surface from a point in empty space, along directions on a grid in the
/// octahedron's parametrisation: it gives visibility without a ray, and always the same answer.
/// Near silhouettes it errs by about a cell, so it may serve beliefs of weights, but no estimate.
class SightMap {
  public:
    SightMap() = default;
    /// Traces kSize * kSize rays.
    SightMap(const Vec3& origin, const PathSpace& space, RayTally& tally);

    /// Whether a light vertex, at infinity too, is in sight as far as the map can tell: not farther
    /// than the farthest of the four cells around its direction, plus 1 %.
    bool sees(const PathVertex& y) const;

    std::uint64_t bytes() const { return farthest_.size() * sizeof(float); }

  private:
    static constexpr std::size_t kSize = 64;  // 32 is a little noisier, 128 not less than 64
    static constexpr std::size_t kCells = kSize - 1;

    Vec3 origin_;
    std::vector<float> farthest_;  // by cell, v and u: squared; infinite where nothing is met
};

}  // namespace lacuna
