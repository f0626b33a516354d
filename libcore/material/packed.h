// Numbers in [0, 1] and directions, packed into 16 bits per number. Every path vertex stores them
// although few need them.
#pragma once

#include <cmath>
#include <cstdint>

#include "libcore/base/octahedron.h"
#include "libcore/base/vec.h"

namespace lacuna {

/// A number in [0, 1], accurate to 1 / 131070.
class PackedUnit {
  public:
    PackedUnit() = default;
    explicit PackedUnit(float x) : bits_(std::uint16_t(std::lrint(x * kMost))) {}
    float value() const { return float(bits_) * (1.0f / kMost); }

  private:
    static constexpr float kMost = 65535.0f;

    std::uint16_t bits_ = 0;
};

/// A colour in [0, 1]^3.
struct PackedColor {
    PackedUnit r, g, b;

    PackedColor() = default;
    explicit PackedColor(const Rgb& c) : r(c.r), g(c.g), b(c.b) {}
    Rgb value() const { return {r.value(), g.value(), b.value()}; }
};

/// A unit direction, accurate to 5e-5.
class PackedDirection {
  public:
    PackedDirection() = default;
    explicit PackedDirection(const Vec3& d) {
        const Vec2 p = octahedronPoint(d);
        u_ = PackedUnit(0.5f + 0.5f * p.x);
        v_ = PackedUnit(0.5f + 0.5f * p.y);
    }
    Vec3 value() const {
        return octahedronDirection({2.0f * u_.value() - 1.0f, 2.0f * v_.value() - 1.0f});
    }

  private:
    PackedUnit u_, v_;
};

}  // namespace lacuna
