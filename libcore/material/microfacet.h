// GGX with Smith's height-correlated masking and shadowing, written without cancellation: D is
// computed from the unnormalised half vector H and H x n (never 1 - cos^2), and G is already
// divided by the cosines. (theory.md, "BSDFs")
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

/// Maps a point of the unit disk to a visible normal [Heitz18], seen from v = (sine, 0, cosine)
/// with cosine > 0 (by isotropy the frame can follow the view). Its density over solid angle is
/// G1(v) (v.h) D(h) / v.z.
inline Vec3 visibleNormal(float sine, float cosine, float alpha, Vec2 disk) {
    // vh: the view in the stretched space, where the lobe is a hemisphere; t1 = y, t2 = vh x y.
    const float inverse = 1.0f / std::sqrt(alpha * alpha * sine * sine + cosine * cosine);
    const float vx = alpha * sine * inverse;
    const float vz = cosine * inverse;
    const float s = 0.5f * (1.0f + vz);
    const float chord = std::sqrt(std::max(0.0f, 1.0f - disk.x * disk.x));
    const float y = (1.0f - s) * chord + s * disk.y;
    const float z = std::sqrt(std::max(0.0f, chord * chord - y * y));
    // The lower bound of the height keeps h off the tangent plane, where it could be the zero
    // vector.
    return normalize(
        Vec3{alpha * (z * vx - y * vz), alpha * disk.x, std::max(1e-7f, z * vz + y * vx)});
}

/// The grain of a brushed surface: alpha along t and along b, which are unit vectors perpendicular
/// to the normal.
struct Grain {
    Vec3 t, b;
    float alphaT, alphaB;
};

/// S of a unit direction whose |cosine| is c.
inline float smithS(float c, const Vec3& v, const Grain& grain) {
    const float x = grain.alphaT * dot(v, grain.t), y = grain.alphaB * dot(v, grain.b);
    return std::sqrt(c * c + x * x + y * y);
}
/// D(h) [Heitz14 eq 85] from H of any length with hDotN = H.n.
inline float distribution(const Vec3& h, float hDotN, const Grain& grain) {
    const float t = dot(h, grain.t), b = dot(h, grain.b);
    const float x = t / grain.alphaT, y = b / grain.alphaB, n2 = hDotN * hDotN;
    const float k = (n2 + t * t + b * b) / (n2 + x * x + y * y);
    return k * k * kInvPi / (grain.alphaT * grain.alphaB);
}

/// As above, seen from the unit vector v with |cosine| > 0; `n` is on the side of v.
inline Vec3 visibleNormal(const Vec3& v, const Vec3& n, float cosine, const Grain& grain,
                          Vec2 disk) {
    const Vec3 vh =
        normalize(Vec3{grain.alphaT * dot(v, grain.t), grain.alphaB * dot(v, grain.b), cosine});
    const float across = vh.x * vh.x + vh.y * vh.y;
    const float inverse = across > 1e-12f ? 1.0f / std::sqrt(across) : 0.0f;
    const Vec3 t1 = across > 1e-12f ? Vec3{-vh.y * inverse, vh.x * inverse, 0.0f} : Vec3{1, 0, 0};
    const Vec3 t2 = cross(vh, t1);
    const float s = 0.5f * (1.0f + vh.z);
    const float y = (1.0f - s) * std::sqrt(std::max(0.0f, 1.0f - disk.x * disk.x)) + s * disk.y;
    const float z = std::sqrt(std::max(0.0f, 1.0f - disk.x * disk.x - y * y));
    const Vec3 h = t1 * disk.x + t2 * y + vh * z;
    return normalize(grain.t * (grain.alphaT * h.x) + grain.b * (grain.alphaB * h.y) +
                     n * std::max(1e-7f, h.z));
}

}  // namespace lacuna::ggx
