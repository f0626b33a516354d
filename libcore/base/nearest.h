// The nearest of many points in space. nearest.cpp is the only file that includes nanoflann.
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
    explicit NearestPoints(std::vector<Vec3> points);
    ~NearestPoints();
    NearestPoints(NearestPoints&&) noexcept;
    NearestPoints& operator=(NearestPoints&&) noexcept;

    std::size_t size() const;
    Vec3 point(std::uint32_t index) const;
    /// The out.size() points nearest to `p`, nearest first. Returns how many were found: fewer only
    /// where there are fewer.
    std::size_t find(Vec3 p, std::span<std::uint32_t> out) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace lacuna
