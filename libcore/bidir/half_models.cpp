// (theory.md, "The error without a reference")
#include "libcore/bidir/half_models.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lacuna {

namespace {

/// Largest a. Where the integrand is smooth over a pixel, errors fall by m^(-1) and faster, but
/// that is not promised.
constexpr double kSteepest = 1.0;

/// 1 if the largest power of two that divides `iterations` has an odd exponent, else 0.
std::size_t oddness(std::uint64_t iterations) {
    return std::size_t(std::countr_zero(iterations)) % 2;
}

/// a in [1/2, kSteepest], from pairs of sizes of which one is four times the other.
double exponentOf(std::span<const HalfDifference> sizes, double uncertainty) {
    double sum = 0.0, weights = 0.0;
    for (const HalfDifference& small : sizes) {
        for (const HalfDifference& large : sizes) {
            if (large.iterations != 4 * small.iterations) continue;
            if (!(small.sum > 0.0 && large.sum > 0.0)) continue;
            const double w = 1.0 / (1.0 / double(small.nodes) + 1.0 / double(large.nodes));
            sum += w * std::log(small.mean() / large.mean());
            weights += w;
        }
    }
    if (weights == 0.0) return 0.5;
    const double falls = (sum / weights - uncertainty / std::sqrt(weights)) / std::log(4.0);
    return std::clamp(falls, 0.5, kSteepest);
}

}  // namespace

SpikeModel::SpikeModel(std::span<const HalfDifference> sizes) {
    double xx = 0.0, x1 = 0.0, one = 0.0, xh = 0.0, h1 = 0.0;
    for (const HalfDifference& d : sizes) {
        const double x = 1.0 / std::sqrt(double(d.iterations)), y = d.mean();
        if (!(y > 0.0)) continue;
        const double w = double(d.nodes) / (y * y);
        xx += w * x * x;
        x1 += w * x;
        one += w;
        xh += w * x * y;
        h1 += w * y;
    }
    const double determinant = xx * one - x1 * x1;
    if (determinant > 0.0) {
        g_ = (xh * one - h1 * x1) / determinant;
        c_ = (h1 * xx - xh * x1) / determinant;
    }
    if (xx > 0.0 && c_ <= 0.0) {
        g_ = xh / xx;
        c_ = 0.0;
    }
    if (one > 0.0 && g_ < 0.0) {
        g_ = 0.0;
        c_ = h1 / one;
    }
}

EvenModel::EvenModel(std::span<const HalfDifference> sizes, double uncertainty)
    : exponent_(exponentOf(sizes, uncertainty)) {
    std::array<double, 2> logs{}, nodes{};
    for (const HalfDifference& d : sizes) {
        if (!(d.sum > 0.0)) continue;
        const std::size_t odd = oddness(d.iterations);
        logs[odd] += double(d.nodes) * (std::log(d.mean()) + exponent_ * std::log(d.iterations));
        nodes[odd] += double(d.nodes);
    }
    if (!(nodes[0] > 0.0 && nodes[1] > 0.0)) return;
    // h(m)^2 m^(2a) is c1 q - c0 where m is an even power of two, and c0 q - c1 where it
    // is an odd one.
    const double q = std::exp2(2.0 * exponent_);
    const double even = std::exp(2.0 * logs[0] / nodes[0]);
    const double odd = std::exp(2.0 * logs[1] / nodes[1]);
    c_ = {(even + odd * q) / (q * q - 1.0), (odd + even * q) / (q * q - 1.0)};
}

double EvenModel::noise(std::uint64_t n) const {
    double sum = 0.0;
    for (std::uint64_t rest = n; rest != 0; rest &= rest - 1) {
        const std::uint64_t m = rest & (~rest + 1);
        const double share = double(m) / double(n);
        sum += share * share * c_[oddness(m)] * std::pow(double(m), -2.0 * exponent_);
    }
    return std::sqrt(sum);
}

}  // namespace lacuna
