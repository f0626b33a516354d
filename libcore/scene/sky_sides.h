// The irradiance from a sky by the orientation of the surface. (theory.md, "Lamps that are seen")
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "libcore/base/octahedron.h"
#include "libcore/base/vec.h"

namespace lacuna {

/// Unoccluded irradiance over its mean over all orientations, tabulated by cells of the octahedral
/// square of directions. Without a sky it is 1.
class SkySides {
  public:
    SkySides() = default;
    /// Accumulates a sky, from which the table is then made.
    class Sum {
      public:
        /// `direction`: unit; `flux`: light from there, per area perpendicular to it.
        void add(const Vec3& direction, double flux) {
            cells_[cellOf(direction, kSumSide)] += Vec3d(direction) * flux;
            whole_ += flux;
        }
        double whole() const { return whole_; }

      private:
        friend class SkySides;
        static constexpr std::size_t kSumSide = 64;
        std::vector<Vec3d> cells_ = std::vector<Vec3d>(kSumSide * kSumSide);
        double whole_ = 0.0;
    };
    /// `sum` must not be empty.
    explicit SkySides(const Sum& sum);

    /// Relative irradiance of a surface with the unit normal `side`.
    float at(const Vec3& side) const { return table_.empty() ? 1.0f : table_[cellOf(side, kSide)]; }

  private:
    static constexpr std::size_t kSide = 32;
    static std::size_t cellOf(const Vec3& direction, std::size_t side) {
        const Vec2 p = octahedronPoint(direction);
        const auto along = [&](float x) {
            return std::min(std::size_t(std::max(0.0f, 0.5f * (x + 1.0f) * float(side))), side - 1);
        };
        return along(p.y) * side + along(p.x);
    }

    std::vector<float> table_;
};

}  // namespace lacuna
