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

}  // namespace lacuna
