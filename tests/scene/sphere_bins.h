// Cells of the sphere of directions, for tests of densities.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "libcore/base/rng.h"
#include "libcore/base/sampling.h"
#include "libcore/base/vec.h"

namespace lacuna::test {

/// Cells around `axis`: z (the cosine to it) times azimuth. z runs over [zLow, 1], for narrow
/// lobes.
class SphereBins {
  public:
    explicit SphereBins(Vec3 axis, int rings = 16, int sectors = 16, double zLow = -1)
        : frame_(axis), rings_(rings), sectors_(sectors), zLow_(zLow) {}

    std::size_t size() const { return std::size_t(rings_) * sectors_; }
    /// Index of the cell of a direction; size() if it is outside.
    std::size_t find(Vec3 direction) const {
        // 1 - cos without cancellation.
        const double oneMinus = 0.5 * lengthSquared(Vec3d(direction) - Vec3d(frame_.n));
        const double ring = (1 - oneMinus / (1 - zLow_)) * rings_;
        if (ring < -1e-3 * rings_) return size();  // farther outside than by rounding
        const double turn = std::atan2(dot(direction, frame_.t), dot(direction, frame_.s)) /
                                (2 * std::numbers::pi) +
                            0.5;
        const int r = std::clamp(int(ring), 0, rings_ - 1);
        const int s = std::clamp(int(turn * sectors_), 0, sectors_ - 1);
        return std::size_t(r) * sectors_ + s;
    }
    /// Integral of `density` over each cell by the midpoints of steps x steps parts.
    std::vector<double> integrate(const std::function<double(Vec3)>& density, int steps) const {
        std::vector<double> mass(size());
        const double cell = 2 * std::numbers::pi * (1 - zLow_) / (double(size()) * steps * steps);
        for (std::size_t i = 0; i < size(); ++i) {
            for (int k = 0; k < steps * steps; ++k) {
                const double ring = double(i / sectors_) + (k / steps + 0.5) / steps;
                const double turn = (double(i % sectors_) + (k % steps + 0.5) / steps) / sectors_;
                const double oneMinus = (1 - ring / rings_) * (1 - zLow_);
                const double r = std::sqrt(oneMinus * (2 - oneMinus));
                const double phi = 2 * std::numbers::pi * (turn - 0.5);
                const Vec3d local{r * std::cos(phi), r * std::sin(phi), 1 - oneMinus};
                const Vec3d d = Vec3d(frame_.s) * local.x + Vec3d(frame_.t) * local.y +
                                Vec3d(frame_.n) * local.z;
                mass[i] += density(Vec3(d)) * cell;
            }
        }
        return mass;
    }

  private:
    Frame frame_;
    int rings_, sectors_;
    double zLow_;
};

/// A uniform random direction.
inline Vec3 randomDirection(Rng& rng) {
    const double z = 2 * rng.uniformDouble() - 1, phi = 2 * std::numbers::pi * rng.uniformDouble();
    const double r = std::sqrt(1 - z * z);
    return Vec3(Vec3d{r * std::cos(phi), r * std::sin(phi), z});
}

}  // namespace lacuna::test
