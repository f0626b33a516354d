#include "libcore/base/discrete.h"

#include <algorithm>

#include "libcore/base/weights.h"

namespace lacuna {

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights) {
    const double largest = largestWeight(weights, "discrete distribution");
    cdf_.resize(weights.size());
    if (largest == 0.0) return;

    // Relative to the largest weight, so that the sum neither overflows nor goes denormal.
    double sum = 0.0;
    std::size_t lastPositive = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += weights[i] / largest;
        cdf_[i] = sum;
        if (weights[i] > 0.0) lastPositive = i;
    }
    for (std::size_t i = 0; i < lastPositive; ++i) cdf_[i] = std::min(cdf_[i] / sum, 1.0);
    for (std::size_t i = lastPositive; i < cdf_.size(); ++i) cdf_[i] = 1.0;
    total_ = sum * largest;

    guide_.reserve(cdf_.size() + 1);
    for (std::size_t k = 0, i = 0; k < cdf_.size(); ++k) {
        while (bucket(cdf_[i]) < k) ++i;  // ends: the last entry is one
        guide_.push_back(std::uint32_t(i));
    }
    guide_.push_back(std::uint32_t(lastPositive));
}

DiscreteDistribution::Pick DiscreteDistribution::sample(double u) const {
    const std::size_t k = std::min(bucket(u), cdf_.size() - 1);
    // First entry above u: an outcome of zero width can never be it. All entries of smaller buckets
    // are at most u, and the first one of a larger bucket is above it.
    const auto it = std::upper_bound(cdf_.begin() + guide_[k], cdf_.begin() + guide_[k + 1], u);
    const auto index = std::size_t(it - cdf_.begin());
    const double below = index == 0 ? 0.0 : cdf_[index - 1];
    return {std::uint32_t(index), cdf_[index] - below, u - below};
}

}  // namespace lacuna
