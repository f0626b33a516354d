// What the distances between halves of a picture say of the whole: models of how they fall with the
// iterations m of a node, h(m). (theory.md, "The error without a reference")
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "libcore/bidir/film_sum.h"

namespace lacuna {

/// h(m) = g m^(-1/2) + c: noise that falls, and rare spikes that do not.
class SpikeModel {
  public:
    /// Least squares of relative distances, a node a measurement.
    explicit SpikeModel(std::span<const HalfDifference> sizes);

    double g() const { return g_; }
    double c() const { return c_; }

  private:
    double g_ = 0.0, c_ = 0.0;
};

/// Means of nodes of m iterations whose numbers are even have the variance c m^(-2a): another c for
/// even powers of two than for odd ones, as 4^k points fill squares. Their halves then differ by
/// h(m)^2 = v(m/2) - v(m).
class EvenModel {
  public:
    /// `uncertainty`: of a node's h, relative. a is the least that they do not speak against.
    EvenModel(std::span<const HalfDifference> sizes, double uncertainty);

    /// Whether it says more than that of independent numbers.
    bool holds() const { return exponent_ > 0.5 && c_[0] > 0.0; }
    /// Root of the variance after n iterations: of one node, or of several that know little of each
    /// other.
    double noise(std::uint64_t n) const;

  private:
    double exponent_;
    std::array<double, 2> c_{};  // of even powers of two, and of odd ones
};

}  // namespace lacuna
