// Light vertices of a pool by the length of their prefix, and pmfs over those of one length that
// are combined from several: what skelbpt and icbpt have in common.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libcore/base/discrete.h"
#include "libcore/bidir/method.h"

namespace lacuna {

/// The connectable vertices of a pool, those of one s together.
class VerticesByLength {
  public:
    /// `direct`: with those on the lights themselves (s = 1).
    void assign(const LightPool& pool, bool direct);

    /// Every s in [1, lengths()]; some may have no vertices.
    int lengths() const { return int(begin_.size()) - 2; }
    std::size_t size() const { return entries_.size(); }
    std::size_t begin(int s) const { return begin_[std::size_t(s)]; }
    std::size_t count(int s) const { return begin_[std::size_t(s) + 1] - begin_[std::size_t(s)]; }
    /// y_0 .. y_{s-1} of a vertex, by its place in [0, size()).
    Subpath prefix(std::size_t place) const { return pool_->prefix(entries_[place]); }

  private:
    const LightPool* pool_ = nullptr;
    std::vector<LightPool::Entry> entries_;
    std::vector<std::size_t> begin_{0, 0};  // by s
};

/// How one of several pmfs is chosen where each outcome belongs to one of them.
enum class Choice {
    Even,  ///< all that hold an outcome alike [Noel15 eq 9]
    Mass   ///< by the probability of the outcomes that are its own
};

/// One pmf out of several over the same outcomes, by the maximum heuristic [Veach97 9.2.3]
/// multiplied in: an outcome belongs to the pmf that gives it the highest probability (ties: to the
/// first), is taken out of the others, and each is made to sum to one again. Choosing one of them
/// and then an outcome is then the same as one pmf over all outcomes.
class CombinedPmf {
  public:
    CombinedPmf() = default;
    /// Rows of equal length with weights of any sum; rows that sum to zero are left out.
    CombinedPmf(std::span<const std::span<const double>> targets, Choice choice);

    bool empty() const { return pmf_.empty(); }
    DiscreteDistribution::Pick sample(double u) const { return pmf_.sample(u); }
    double pmf(std::size_t outcome) const { return pmf_.pmf(outcome); }
    /// The row that the outcome belongs to.
    std::uint32_t owner(std::size_t outcome) const { return owner_[outcome]; }

    /// Sum of a row's weights.
    double sum(std::size_t row) const { return sum_[row]; }
    /// Sum over the outcomes of the highest probability that a row gives them, in [1, rows]: what
    /// the choice by mass divides each by. Zero where empty().
    double maxima() const { return maxima_; }
    std::uint64_t bytes() const { return pmf_.bytes() + owner_.size(); }

  private:
    DiscreteDistribution pmf_;
    std::vector<std::uint8_t> owner_;
    std::vector<double> sum_;
    double maxima_ = 0.0;
};

}  // namespace lacuna
