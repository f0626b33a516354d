// Search for the nearest of many points on surfaces. nearest.cpp is the only file that includes
// nanoflann.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

/// A k-d tree over points; const after construction. Among equally distant points, the tree decides
/// which one is found. The tree depends on the points and their order alone.
class NearestPoints {
  public:
    NearestPoints();
    /// `sides`: the unit direction that each point faces, or zero for none. The squared distance of
    /// two points is that of their positions plus that of their sides times `sideLength`^2.
    NearestPoints(std::vector<Vec3> points, std::vector<Vec3> sides, float sideLength);
    ~NearestPoints();
    NearestPoints(NearestPoints&&) noexcept;
    NearestPoints& operator=(NearestPoints&&) noexcept;

    std::size_t size() const;
    /// Writes the indices of the out.size() points nearest to the point `p` that faces `side`,
    /// nearest first. Returns their number, which is less than out.size() only if there are fewer
    /// points.
    std::size_t find(Vec3 p, Vec3 side, std::span<std::uint32_t> out) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace lacuna
