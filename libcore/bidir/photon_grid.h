// Photons by place: a hashed grid that finds those within a fixed distance of a point. (theory.md, "Merging")
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/bidir/path.h"

namespace lacuna {

class PhotonGrid {
  public:
    PhotonGrid() = default;
    /// Grid of those `vertices` that `photons` lists, for queries within `radius` >= 0 (scene units). The order of
    /// answers depends on the order of the two lists alone.
    PhotonGrid(std::span<const PathVertex> vertices, std::span<const std::uint32_t> photons,
               double radius);

    bool empty() const { return photons_.empty(); }
    std::size_t bytes() const;

    /// Appends the indices of all photons nearer than the radius.
    void find(const Vec3& place, std::vector<std::uint32_t>& found) const;

  private:
    struct Photon {
        Vec3 position;
        std::uint32_t vertex;
    };
    /// The first of the two cells along an axis that hold all points within the radius of `x`.
    std::int64_t firstCell(float x) const;
    std::int64_t cellOf(float x) const;
    std::size_t bucketOf(std::int64_t x, std::int64_t y, std::int64_t z) const;

    double radius_ = 0, cell_ = 1;
    std::vector<std::uint32_t> begins_;  // by bucket, and the end
    std::vector<Photon> photons_;        // by bucket
};

}  // namespace lacuna
