// Triangles, and points that lie evenly on all of them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libcore/base/discrete.h"
#include "libcore/base/rng.h"
#include "libcore/base/vec.h"

namespace lacuna {

class TrianglesByArea {
  public:
    explicit TrianglesByArea(std::vector<std::array<Vec3, 3>> triangles);

    bool empty() const { return byArea_.empty(); }
    struct Point {
        Vec3 position;
        std::uint32_t triangle;
    };
    /// A point, evenly over all of their area. Not to be called when empty().
    Point sample(Rng& rng) const;
    double area() const { return area_; }
    /// Unit, on the side from which the triangle's corners run counter-clockwise.
    Vec3 normal(std::uint32_t triangle) const;

  private:
    std::vector<std::array<Vec3, 3>> triangles_;
    DiscreteDistribution byArea_;
    double area_ = 0.0;
};

}  // namespace lacuna
