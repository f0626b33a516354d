// Small fixed-size vectors: points, directions, normals (Vec3), texture coordinates (Vec2) and
// linear Rec. 709 colour (Rgb). Positions are float, relative to the recentred scene; products of
// densities and anything that subtracts nearby numbers is done in double (Vec3d).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#ifdef __FAST_MATH__
#error "isFinite is always true with -ffast-math, and no invalid sample would be counted"
#endif

namespace lacuna {

template <class T>
struct Vec3T {
    T x{}, y{}, z{};

    constexpr Vec3T() = default;
    constexpr Vec3T(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    template <class U>
    constexpr explicit Vec3T(const Vec3T<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}

    constexpr T& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
    constexpr const T& operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }

    constexpr Vec3T& operator+=(const Vec3T& b) { return *this = *this + b; }
    constexpr Vec3T& operator-=(const Vec3T& b) { return *this = *this - b; }
    constexpr Vec3T& operator*=(T s) { return *this = *this * s; }

    friend constexpr Vec3T operator+(const Vec3T& a, const Vec3T& b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend constexpr Vec3T operator-(const Vec3T& a, const Vec3T& b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    friend constexpr Vec3T operator-(const Vec3T& a) { return {-a.x, -a.y, -a.z}; }
    friend constexpr Vec3T operator*(const Vec3T& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
    friend constexpr Vec3T operator*(T s, const Vec3T& a) { return a * s; }
    friend constexpr Vec3T operator/(const Vec3T& a, T s) { return a * (T(1) / s); }
    friend constexpr bool operator==(const Vec3T&, const Vec3T&) = default;
};

using Vec3 = Vec3T<float>;
using Vec3d = Vec3T<double>;

template <class T>
constexpr T dot(const Vec3T<T>& a, const Vec3T<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3T<T> cross(const Vec3T<T>& a, const Vec3T<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
constexpr T lengthSquared(const Vec3T<T>& v) {
    return dot(v, v);
}
template <class T>
T length(const Vec3T<T>& v) {
    return std::sqrt(dot(v, v));
}
/// Unit vector along `v`; the zero vector stays zero.
template <class T>
Vec3T<T> normalize(const Vec3T<T>& v) {
    const T l = length(v);
    return l > T(0) ? v * (T(1) / l) : v;
}
template <class T>
bool isFinite(const Vec3T<T>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
template <class T>
constexpr Vec3T<T> min(const Vec3T<T>& a, const Vec3T<T>& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
template <class T>
constexpr Vec3T<T> max(const Vec3T<T>& a, const Vec3T<T>& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

struct Vec2 {
    float x{}, y{};
    friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
    friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
    friend constexpr Vec2 operator*(Vec2 a, float s) { return {a.x * s, a.y * s}; }
    friend constexpr bool operator==(Vec2, Vec2) = default;
};

/// Linear Rec. 709 radiance, reflectance or throughput.
struct Rgb {
    float r{}, g{}, b{};

    constexpr Rgb() = default;
    constexpr explicit Rgb(float grey) : r(grey), g(grey), b(grey) {}
    constexpr Rgb(float r_, float g_, float b_) : r(r_), g(g_), b(b_) {}

    constexpr Rgb& operator+=(const Rgb& o) { return *this = *this + o; }
    constexpr Rgb& operator*=(const Rgb& o) { return *this = *this * o; }
    constexpr Rgb& operator*=(float s) { return *this = *this * s; }

    friend constexpr Rgb operator+(const Rgb& a, const Rgb& b) {
        return {a.r + b.r, a.g + b.g, a.b + b.b};
    }
    friend constexpr Rgb operator-(const Rgb& a, const Rgb& b) {
        return {a.r - b.r, a.g - b.g, a.b - b.b};
    }
    friend constexpr Rgb operator*(const Rgb& a, const Rgb& b) {
        return {a.r * b.r, a.g * b.g, a.b * b.b};
    }
    friend constexpr Rgb operator*(const Rgb& a, float s) { return {a.r * s, a.g * s, a.b * s}; }
    friend constexpr Rgb operator*(float s, const Rgb& a) { return a * s; }
    friend constexpr bool operator==(const Rgb&, const Rgb&) = default;
};

/// Mean of the channels, which every selection uses as its weight. It is positive wherever any
/// channel is. It is linear, so that sums may be carried along a path.
constexpr float mean(const Rgb& c) {
    return (c.r + c.g + c.b) * (1.0f / 3.0f);
}
constexpr float minComponent(const Rgb& c) {
    return c.r < c.g ? (c.r < c.b ? c.r : c.b) : (c.g < c.b ? c.g : c.b);
}
constexpr float maxComponent(const Rgb& c) {
    return std::max(c.r, std::max(c.g, c.b));
}
constexpr bool isBlack(const Rgb& c) {
    return bool(int(c.r == 0.0f) & int(c.g == 0.0f) & int(c.b == 0.0f));  // one branch
}
inline bool isFinite(const Rgb& c) {
    return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}

/// Affine map p -> M p + t in double, columns m[0..2], translation m[3].
struct Affine {
    std::array<Vec3d, 4> m{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{0, 0, 0}};

    constexpr Vec3d vector(const Vec3d& v) const { return m[0] * v.x + m[1] * v.y + m[2] * v.z; }
    constexpr Vec3d point(const Vec3d& p) const { return vector(p) + m[3]; }
    constexpr double determinant() const { return dot(m[0], cross(m[1], m[2])); }
    /// Transform of normals up to scale: the cofactor matrix. Under negative scale it keeps the
    /// side: a normal that belongs to the winding stays on the winding's side after the sign is
    /// applied.
    constexpr Vec3d normal(const Vec3d& n) const {
        return cross(m[1], m[2]) * n.x + cross(m[2], m[0]) * n.y + cross(m[0], m[1]) * n.z;
    }
    friend constexpr Affine operator*(const Affine& a, const Affine& b) {
        return {{a.vector(b.m[0]), a.vector(b.m[1]), a.vector(b.m[2]), a.point(b.m[3])}};
    }
};

}  // namespace lacuna
