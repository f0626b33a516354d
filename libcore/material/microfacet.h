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

/// The visible normal that a point of the unit disk stands for; v is local with v.z > 0 [Heitz18].
/// Its density over solid angle is G1(v) (v.h) D(h) / v.z.
template <class T>
Vec3T<T> visibleNormal(const Vec3T<T>& v, T alpha, T diskX, T diskY) {
    const Vec3T<T> vh = normalize(Vec3T<T>{alpha * v.x, alpha * v.y, v.z});
    const T l2 = vh.x * vh.x + vh.y * vh.y;
    Vec3T<T> t1{T(1), T(0), T(0)};
    if (l2 > T(0)) {
        const T inverse = T(1) / std::sqrt(l2);
        t1 = {-vh.y * inverse, vh.x * inverse, T(0)};
    }
    const Vec3T<T> t2 = cross(vh, t1);
    const T s = T(0.5) * (T(1) + vh.z);
    const T y = (T(1) - s) * std::sqrt(std::max(T(0), T(1) - diskX * diskX)) + s * diskY;
    const T z = std::sqrt(std::max(T(0), T(1) - diskX * diskX - y * y));
    const Vec3T<T> nh = t1 * diskX + t2 * y + vh * z;
    // A floor on z keeps h off the tangent plane, where it would be the zero vector.
    return normalize(Vec3T<T>{alpha * nh.x, alpha * nh.y, std::max(T(1e-7), nh.z)});
}

}  // namespace lacuna::ggx
