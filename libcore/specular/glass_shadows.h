// A table over the scene's space of where next event through smooth glass is worth a try. That is where glass lies
// between a place and a lamp, and the more so the more of the lamp's light comes as far as the glass. (theory.md, "Next
// event through glass")
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/scene/scene.h"
#include "libcore/specular/boxes.h"

namespace lacuna {

class GlassShadows {
  public:
    /// `glass` is glassInBoxes(), `facets` is facetsInBoxes(). Next event joins lights without a size through
    /// the latter alone.
    GlassShadows(const Scene& scene, std::span<const BoxedTriangles> glass,
                 std::span<const BoxedTriangles> facets = {});

    /// Whether there is no glass, or no light behind it.
    bool empty() const { return cells_.empty(); }
    /// Whether some straight way from a place of the scene to a lamp or the sky may meet glass. Neither this nor
    /// triesAt() may be called when empty().
    bool reach(const Vec3& place) const {
        const Cell cell = cellOf(place);
        return (rows_[cell.row] >> cell.x & 1) != 0;
    }
    /// Expected number of tries at a place: zero where reach() is false, else in [kLeast, 1].
    double triesAt(const Vec3& place) const {
        const Cell cell = cellOf(place);
        return kOfCode * double(cells_[cell.row * kSide + cell.x]);
    }

    /// Tries where no lamp was seen to shine on the glass: its light may come through a gap all the same.
    static constexpr double kLeast = 1.0 / 16.0;

  private:
    static constexpr std::size_t kSide = 32;  // cells along an axis, and bits of a row
    static constexpr double kOfCode = 1.0 / 240.0;

    /// Glass, and a lamp or the sky, whose light it may bring.
    struct Pair {
        Box glass;
        Box lamp;
        bool sky;
        std::uint8_t code;  ///< tries over kOfCode
    };
    /// A cube of cells, from one corner on.
    struct Cube {
        std::size_t x, y, z, side;
    };

    struct Cell {
        std::size_t row, x;
    };
    Cell cellOf(const Vec3& place) const {
        const auto index = [](float x, float toCells) {
            constexpr float kMiddle = float(kSide) / 2;
            return std::min<std::uint32_t>(std::uint32_t(int(x * toCells + kMiddle)), kSide - 1);
        };
        return {index(place.z, toCells_.z) * kSide + index(place.y, toCells_.y),
                index(place.x, toCells_.x)};
    }
    Box boxOf(const Cube& cube, const Vec3& half, float margin) const;
    void fill(const Cube& cube, std::span<const Pair> pairs, const Vec3& half, float margin);

    Vec3 toCells_;
    std::vector<std::uint8_t> cells_;  // Pair::code of the best pair
    std::vector<std::uint32_t> rows_;  // one bit per cell: has a pair; fits in the cache
};

}  // namespace lacuna
