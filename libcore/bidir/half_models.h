// Models of h(m), the difference between the halves of a node of m iterations. They tell the
// error of the whole picture from the differences between its parts. (theory.md, "The error
// without a reference")
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "libcore/bidir/film_sum.h"

namespace lacuna {

/// h(m) = g m^(-1/2) + c: noise that falls, and rare spikes that do not.
class SpikeModel {
  public:
    /// Fits g and c by least squares of relative deviations. Each node counts as one measurement.
    explicit SpikeModel(std::span<const HalfDifference> sizes);

    double g() const { return g_; }
    double c() const { return c_; }

  private:
    double g_ = 0.0, c_ = 0.0;
};

/// v(m) = c m^(-2a), the variance of the mean of a node of m iterations whose random numbers are
/// even. c has one value for even powers of two and another for odd ones, as 4^k points fill
/// squares. The halves of a node then differ by h(m)^2 = v(m/2) - v(m).
class EvenModel {
  public:
    /// `uncertainty` is the relative one of a node's h. a is the least value that `sizes`
    /// allow within it.
    EvenModel(std::span<const HalfDifference> sizes, double uncertainty);

    /// Whether the variance falls faster than that of independent numbers.
    bool holds() const { return exponent_ > 0.5 && c_[0] > 0.0; }
    /// Root of the variance after n iterations: of one node, or of several as if they
    /// were independent.
    double noise(std::uint64_t n) const;

  private:
    double exponent_;
    std::array<double, 2> c_{};  // c for even powers of two, and for odd ones
};

}  // namespace lacuna
