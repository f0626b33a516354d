// A table that picks one of n outcomes with given weights.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/below1.h"

namespace lacuna {

/// Cumulative distribution over n outcomes, accumulated in double. The entry of the last outcome
/// with POSITIVE weight and all entries after it are one, so that no outcome of weight zero is ever
/// returned. An outcome whose share of the sum is below 2^-53 may get probability zero. The
/// reported pmf is the realised one: a difference of two stored entries. With a guide table
/// [Chen74], a pick costs two memory accesses, however many outcomes there are.
class DiscreteDistribution {
  public:
    DiscreteDistribution() = default;
    /// Weights >= 0 and finite, any dynamic range, any sum. Throws std::invalid_argument naming the
    /// first bad entry. A zero sum (or no entries) gives an empty distribution.
    explicit DiscreteDistribution(std::span<const double> weights);

    /// Whether no outcome can be picked: all weights are zero, or there are none.
    bool empty() const { return total_ <= 0.0; }
    std::size_t size() const { return cdf_.size() - 1; }
    /// Sum of the weights.
    double total() const { return total_; }
    /// Realised probability of `index`, zero out of range.
    double pmf(std::size_t index) const {
        return index < size() ? cdf_[index + 1] - cdf_[index] : 0.0;
    }

    /// Realised probability of all outcomes before `index`, which is at most size().
    double before(std::size_t index) const { return cdf_[index]; }

    struct Pick {
        std::uint32_t index;
        double pmf;
        double rest;  ///< u minus the probability of all outcomes before this one
        /// u, rescaled to [0, 1) within the outcome; can be reused.
        double remapped() const { return std::max(0.0, below1(rest / pmf)); }
    };
    /// Picks an outcome with u in [0, 1). Must not be called when empty().
    Pick sample(double u) const {
        const std::size_t k = std::min(bucket(u), size() - 1);
        // The pick is the first outcome that ends above u, which never has zero width. Outcomes
        // that end in smaller buckets end at most at u; the first outcome that ends in a larger
        // bucket ends above u.
        const double* const ends = cdf_.data() + 1;
        std::size_t index = guide_[k];
        // A sum and not a branch: u is random, so that a branch predictor would often be wrong.
        // Where outcomes are about equally likely, this is the only step.
        index += std::size_t(ends[index] <= u);
        if (ends[index] <= u) {
            index = std::size_t(std::upper_bound(ends + index, ends + guide_[k + 1], u) - ends);
        }
        return {std::uint32_t(index), cdf_[index + 1] - cdf_[index], u - cdf_[index]};
    }

    std::uint64_t bytes() const {
        return cdf_.size() * sizeof(double) + guide_.size() * sizeof(std::uint32_t);
    }

  private:
    /// Index of the guide entry of u; monotonic, whatever rounding does.
    std::size_t bucket(double u) const { return std::size_t(u * double(size())); }

    std::vector<double> cdf_ = {0.0};   // where each outcome begins, and the end of the last one
    std::vector<std::uint32_t> guide_;  // by bucket: its first outcome; and one more entry
    double total_ = 0.0;
};

}  // namespace lacuna
