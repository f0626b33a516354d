// Maps from the unit square to directions, and orthonormal frames. No trigonometric call: angles
// are brought into [-pi/4, pi/4], where short polynomials are exact to float precision.
#pragma once

#include <algorithm>
#include <cmath>

#include "libcore/base/vec.h"

namespace lacuna {

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInvPi = 0.31830988618379067154f;

/// Right-handed orthonormal frame around a unit normal [Duff et al. 2017].
struct Frame {
    Vec3 s, t, n;

    Frame() = default;
    explicit Frame(Vec3 normal) : n(normal) {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        s = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
        t = {b, sign + n.y * n.y * a, -n.y};
    }
    Vec3 toWorld(Vec3 v) const { return s * v.x + t * v.y + n * v.z; }
    Vec3 toLocal(Vec3 v) const { return {dot(v, s), dot(v, t), dot(v, n)}; }
};

struct SineCosine {
    float sine, cosine;
};

/// Sine and cosine of an angle in [-pi/4, pi/4]: the kernels of Cephes' sinf and cosf.
inline SineCosine sineCosineNearZero(float x) {
    const float z = x * x;
    return {
        x + x * z * (-1.6666654611e-1f + z * (8.3321608736e-3f + z * -1.9515295891e-4f)),
        1.0f - 0.5f * z +
            z * z *
                (4.166664568298827e-2f + z * (-1.388731625493765e-3f + z * 2.443315711809948e-5f))};
}

/// Sine and cosine of an angle in whole turns, where |turns| is at most a few.
inline SineCosine sineCosineOfTurns(float turns) {
    const float quarters = std::nearbyint(4.0f * turns);
    const SineCosine near = sineCosineNearZero((turns - 0.25f * quarters) * (2.0f * kPi));
    const unsigned quadrant = unsigned(int(quarters)) & 3u;
    const float sine = quadrant & 1u ? near.cosine : near.sine;
    const float cosine = quadrant & 1u ? near.sine : near.cosine;
    return {quadrant >= 2 ? -sine : sine, quadrant == 1 || quadrant == 2 ? -cosine : cosine};
}

/// atan2(y, x) in whole turns, in [-1/2, 1/2], accurate to 1e-8 of a turn but for rounding; 0 for
/// (0, 0) [Abramowitz64 4.4.49].
inline float turnsOf(float y, float x) {
    const float ax = std::abs(x), ay = std::abs(y);
    const float longer = std::max(ax, ay), shorter = std::min(ax, ay);
    const float a = longer > 0.0f ? shorter / longer : 0.0f;
    const float z = a * a;
    const float radians =
        a * (1.0f + z * (-0.3333314528f +
                         z * (0.1999355085f +
                              z * (-0.1420889944f +
                                   z * (0.1065626393f +
                                        z * (-0.0752896400f +
                                             z * (0.0429096138f +
                                                  z * (-0.0161657367f + z * 0.0028662257f))))))));
    float turns = radians * (0.5f * kInvPi);
    turns = ay > ax ? 0.25f - turns : turns;
    turns = x < 0.0f ? 0.5f - turns : turns;
    return std::copysign(turns, y);
}

/// Barycentrics of the second and the third corner, uniform over the area of a triangle.
inline Vec2 uniformTriangle(float u1, float u2) {
    const float s = std::sqrt(u1);
    return {1.0f - s, u2 * s};
}

/// Uniform point of the unit disk, area-preserving and continuous [Shirley and Chiu 1997].
inline Vec2 concentricDisk(float u1, float u2) {
    const float a = 2.0f * u1 - 1.0f;
    const float b = 2.0f * u2 - 1.0f;
    // Selections, not branches: a predictor cannot know which of two random numbers is larger.
    const bool aLonger = std::abs(a) > std::abs(b);
    const float radius = aLonger ? a : b;
    const float other = aLonger ? b : a;
    const SineCosine angle =
        sineCosineNearZero((kPi / 4) * (other / (radius != 0.0f ? radius : 1.0f)));
    const float sine = radius * angle.sine, cosine = radius * angle.cosine;
    return {aLonger ? cosine : sine, aLonger ? sine : cosine};
}

/// Normalises a vector that is unit but for rounding: one Newton step for 1 / sqrt.
inline Vec3 renormalize(Vec3 v) {
    return v * (1.5f - 0.5f * dot(v, v));
}

/// Local direction (z up), sampled with pdfW = z / pi.
inline Vec3 cosineHemisphere(float u1, float u2) {
    const Vec2 p = concentricDisk(u1, u2);
    return {p.x, p.y, std::sqrt(std::max(0.0f, 1.0f - p.x * p.x - p.y * p.y))};
}

}  // namespace lacuna
