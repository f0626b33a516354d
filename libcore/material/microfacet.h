// Isotropic GGX with Smith's height-correlated masking and shadowing, written so that nothing
// cancels: D from the unnormalised half vector H and H x n (never 1 - cos^2), G already divided by
// the cosines.
#pragma once

#include <algorithm>
#include <cmath>

#include "libcore/base/sampling.h"
#include "libcore/base/vec.h"

namespace lacuna::ggx {

/// S(c) = c sqrt(1 + alpha^2 tan^2) for |cosine| = c, so that Smith's Lambda = (S/c - 1) / 2.
template <class T>
T smithS(T c, T alpha2) {
    return std::sqrt(c * c + alpha2 * std::max(T(0), T(1) - c * c));
}
/// G1 / c, [Heitz14 eq 72]: bounded by 2 / alpha at grazing angles.
template <class T>
T g1OverCosine(T c, T s) {
    return T(2) / (c + s);
}
/// G2 / (c_i c_o), height-correlated: 1 / (1 + Lambda_i + Lambda_o) [Heitz14 eq 99].
template <class T>
T g2OverCosines(T ci, T si, T co, T so) {
    return T(2) / (si * co + so * ci);
}
/// D(h) [Walter07 eq 33] from H of any length: hDotN = H.n, crossSquared = |H x n|^2.
template <class T>
T distribution(T alpha, T hDotN, T crossSquared) {
    const T hn2 = hDotN * hDotN;
    const T k = alpha * (hn2 + crossSquared) / (alpha * alpha * hn2 + crossSquared);
    return k * k * T(kInvPi);
}

/// The visible normal that a point of the unit disk stands for [Heitz18], seen from v = (sine, 0,
/// cosine) with cosine > 0 (isotropy lets the frame follow the view). Its density over solid angle
/// is G1(v) (v.h) D(h) / v.z.
inline Vec3 visibleNormal(float sine, float cosine, float alpha, Vec2 disk) {
    // The view in the space where the lobe is a hemisphere; t1 = y, t2 = vh x y.
    const float inverse = 1.0f / std::sqrt(alpha * alpha * sine * sine + cosine * cosine);
    const float vx = alpha * sine * inverse;
    const float vz = cosine * inverse;
    const float s = 0.5f * (1.0f + vz);
    const float chord = std::sqrt(std::max(0.0f, 1.0f - disk.x * disk.x));
    const float y = (1.0f - s) * chord + s * disk.y;
    const float z = std::sqrt(std::max(0.0f, chord * chord - y * y));
    // A floor on the height keeps h off the tangent plane, where it would be the zero vector.
    return normalize(
        Vec3{alpha * (z * vx - y * vz), alpha * disk.x, std::max(1e-7f, z * vz + y * vx)});
}

}  // namespace lacuna::ggx
