// Bins over all directions, and integrals over them: cells by angle about an axis. For lobes
// that are wider than a cell, wherever they point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "libcore/base/sampling.h"
#include "libcore/base/vec.h"

namespace lacuna::test {

class SphereBins {
  public:
    static constexpr int kRings = 8;  ///< per hemisphere
    static constexpr int kSectors = 16;
    static constexpr int kSteps = 32;  ///< midpoints per bin and axis

    explicit SphereBins(Vec3 axis) : frame_(axis) {}

    std::size_t size() const { return std::size_t(2 * kRings * kSectors); }

    /// Bin of a direction.
    std::size_t binOf(Vec3 to) const {
        const double cosine = std::clamp(double(dot(to, frame_.n)), -1.0, 1.0);
        const double phi = std::atan2(double(dot(to, frame_.t)), double(dot(to, frame_.s)));
        const double theta = std::acos(cosine) / std::numbers::pi;
        const int ring = std::clamp(int(theta * 2 * kRings), 0, 2 * kRings - 1);
        const double turn = phi / (2 * std::numbers::pi) + 0.5;
        return index(ring, std::clamp(int(turn * kSectors), 0, kSectors - 1));
    }

    /// Calls visit(bin, to, solid angle) for the midpoints of all bins.
    template <class Visit>
    void integrate(const Visit& visit) const {
        const int rows = 2 * kRings * kSteps, columns = kSectors * kSteps;
        for (int i = 0; i < rows; ++i) {
            const double theta = (i + 0.5) * std::numbers::pi / rows;
            const double z = std::cos(theta), r = std::sin(theta);
            const double solidAngle =
                r * (std::numbers::pi / rows) * (2 * std::numbers::pi / columns);
            for (int j = 0; j < columns; ++j) {
                const double phi = ((j + 0.5) / columns - 0.5) * 2 * std::numbers::pi;
                const Vec3 to =
                    frame_.toWorld(Vec3(Vec3d{r * std::cos(phi), r * std::sin(phi), z}));
                visit(index(i / kSteps, j / kSteps), to, solidAngle);
            }
        }
    }

  private:
    static std::size_t index(int ring, int sector) { return std::size_t(ring * kSectors + sector); }

    Frame frame_;
};

}  // namespace lacuna::test
