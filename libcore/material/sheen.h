// The sheen of cloth by upright microfibres [Estevez17], as in KHR_materials_sheen. It is brightest
// at grazing angles. (theory.md, "BSDFs")
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace lacuna {

namespace sheen {

/// alpha of a roughness in [0, 1], with a lower bound: below it, a sheen is a rim too thin for
/// floats to sample.
template <class T>
T alphaOf(T roughness) {
    const T r = std::max(T(0.07), roughness);
    return r * r;
}

/// D, "Charlie" [Estevez17 eq 2]; sine2 of the half vector and the normal.
template <class T>
T distribution(T alpha, T sine2) {
    constexpr T kInvTwoPi = T(0.15915494309189533577);
    const T inverse = T(1) / alpha;
    return (T(2) + inverse) * std::pow(std::max(T(0), sine2), T(0.5) * inverse) * kInvTwoPi;
}

/// The fit of Smith's Lambda [Estevez17 eq 3].
template <class T>
class Shadowing {
  public:
    explicit Shadowing(T alpha) {
        const T k = (T(1) - alpha) * (T(1) - alpha);
        const auto between = [&](double smooth, double rough) {
            return T(rough) + (T(smooth) - T(rough)) * k;
        };
        a_ = between(25.3245, 21.5473);
        b_ = between(3.32435, 3.82987);
        c_ = between(0.16801, 0.19823);
        d_ = between(-1.27393, -1.97760);
        e_ = between(-4.85967, -4.32054);
    }
    T lambda(T cosine) const {
        if (cosine < T(0.5)) return std::exp(fit(cosine));
        return std::exp(T(2) * fit(T(0.5)) - fit(std::max(T(0), T(1) - cosine)));
    }

  private:
    T fit(T x) const { return a_ / (T(1) + b_ * std::pow(x, c_)) + d_ * x + e_; }

    T a_, b_, c_, d_, e_;
};

}  // namespace sheen

/// E(mu) of a white sheen, from 0 to somewhat above 1: for roughness below .25, the model reflects more than it
/// receives at grazing angles. Made once for all scenes.
class SheenTable {
  public:
    SheenTable();

    /// E(mu), for mu and roughness in [0, 1].
    float directional(float roughness, float mu) const;

  private:
    static constexpr int kRoughnesses = 32, kCosines = 128;

    std::vector<float> values_;  // [roughness][root of mu]
};

/// The table; the first call makes it.
const SheenTable& sheenTable();

}  // namespace lacuna
