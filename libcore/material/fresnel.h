// Reflectance of a smooth interface, for float (rendering) and double (tables).
#pragma once

#include <cmath>

#include "libcore/base/vec.h"

namespace lacuna {

/// Exact unpolarised Fresnel reflectance [Walter07 eq 22]. `cosine` >= 0 is on the incident side;
/// `eta` is the transmitted over the incident index. 1 for total internal reflection.
template <class T>
T fresnelDielectric(T cosine, T eta) {
    const T k = (eta - T(1)) * (eta + T(1));
    const T g2 = k + cosine * cosine;
    if (!(g2 > T(0))) {
        return eta == T(1) ? T(0) : T(1);
    }
    const T sum = std::sqrt(g2) + cosine;
    const T difference = k / sum;  // g - c, without cancellation for eta near 1
    const T x = cosine * sum - T(1);
    const T y = cosine * difference + T(1);
    const T denominator = sum * y;
    return T(0.5) * difference * difference * (x * x + y * y) / (denominator * denominator);
}

/// Schlick's weight w of white: F = F0 + (1 - F0) w.
inline float schlickWeight(float cosine) {
    const float m = 1.0f - cosine;
    const float m2 = m * m;
    return m > 0.0f ? m2 * m2 * m : 0.0f;
}
inline Rgb schlick(const Rgb& f0, float cosine) {
    return f0 + (Rgb(1.0f) - f0) * schlickWeight(cosine);
}

/// Cosine-weighted mean 2 int F(mu) mu dmu of fresnelDielectric for n >= 1 [Walsh 1926,
/// Duntley 1942].
inline double fresnelAverage(double n) {
    const double d = n - 1;
    if (d < 1e-6) {
        return 0;  // the true value is below 2e-6; the closed form cancels
    }
    const double n2 = n * n;
    const double n4 = n2 * n2;
    const double s = n + 1;
    const double p = n2 + 1;
    const double m = d * s * p;  // n^4 - 1
    return 0.5 + d * (3 * n + 1) / (6 * s * s) +
           n2 * (n2 - 1) * (n2 - 1) / (p * p * p) * std::log(d / s) -
           2 * n2 * n * (n2 + 2 * n - 1) / (p * m) +
           8 * n4 * (n4 + 1) / (p * m * m) * std::log1p(d);
}

}  // namespace lacuna
