// Statistical tests with one false-alarm rate for all of them together (Sidak).
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace lacuna::test {

/// Uniform floats in [0, 1) from a fixed seed.
class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    float next() { return float(engine_() >> 40) * 0x1p-24f; }
    double real() { return double(engine_() >> 11) * 0x1p-53; }

  private:
    std::mt19937_64 engine_;
};

/// P(Z > z); both tails if `sides` is 2.
inline double normalTail(double z, int sides = 1) {
    return 0.5 * sides * std::erfc(z / std::sqrt(2.0));
}

/// The value that Student's t with `dof` degrees of freedom exceeds as often as a normal variable
/// exceeds z. It replaces a bound of z standard errors if these were estimated from dof + 1
/// samples. After Wallace 1959; accurate to 1 % for dof >= 20 and z <= 6.
inline double studentQuantile(double z, double dof) {
    const double scaled = z * (8.0 * dof + 3.0) / (8.0 * dof + 1.0);
    return std::sqrt(dof * std::expm1(scaled * scaled / dof));
}

/// P(chi^2 with `dof` > x) after Wilson and Hilferty; accurate to a factor of two far in the tail.
inline double chiSquareTail(double x, double dof) {
    const double k = 2.0 / (9.0 * dof);
    return normalTail((std::cbrt(x / dof) - (1.0 - k)) / std::sqrt(k));
}

/// Significance of each of `tests` tests such that one false alarm in all has probability `total`.
inline double sidak(double total, double tests) {
    return -std::expm1(std::log1p(-total) / tests);
}

/// The number of standard errors, estimated from dof + 1 samples, that any of `tests` two-sided
/// tests exceeds with probability `total`.
inline double allowedErrors(double total, double tests, double dof) {
    const double significance = sidak(total, tests);
    double low = 0.0, high = 40.0;
    for (int i = 0; i < 100; ++i) {
        const double z = 0.5 * (low + high);
        (normalTail(z, 2) > significance ? low : high) = z;
    }
    return studentQuantile(low, dof);
}

/// Mean and its standard error, in one pass.
class Moments {
  public:
    void add(double x) {
        ++count_;
        const double d = x - mean_;
        mean_ += d / double(count_);
        m2_ += d * (x - mean_);
    }
    double mean() const { return mean_; }
    double standardError() const {
        return count_ > 1 ? std::sqrt(m2_ / double(count_ - 1) / double(count_)) : 0.0;
    }

  private:
    std::int64_t count_ = 0;
    double mean_ = 0, m2_ = 0;
};

}  // namespace lacuna::test
