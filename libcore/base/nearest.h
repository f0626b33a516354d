// The nearest of many points that lie on surfaces. nearest.cpp is the only file that includes
// nanoflann.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

/// A k-d tree over points; const after construction. Of points that are equally far it depends on
/// the tree which one is found, and the tree on the points and their order alone.
class NearestPoints {
  public:
    NearestPoints();
    /// `sides`: where each looks to, a unit vector, or zero for no side. The squared distance of two
    /// is that of their places plus that of their sides times `sideLength`^2.
    NearestPoints(std::vector<Vec3> points, std::vector<Vec3> sides, float sideLength);
    ~NearestPoints();
    NearestPoints(NearestPoints&&) noexcept;
    NearestPoints& operator=(NearestPoints&&) noexcept;

    std::size_t size() const;
    /// The out.size() points nearest to `p` that looks to `side`, nearest first. Returns how many
    /// were found: fewer only where there are fewer.
    std::size_t find(Vec3 p, Vec3 side, std::span<std::uint32_t> out) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace lacuna
