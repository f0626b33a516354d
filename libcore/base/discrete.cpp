#include "libcore/base/discrete.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lacuna {

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights) {
    double largest = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        if (!(weights[i] >= 0.0) || !std::isfinite(weights[i])) {
            throw std::invalid_argument("discrete distribution: weight " + std::to_string(i) +
                                        " is " + std::to_string(weights[i]) +
                                        ", expected a finite number >= 0");
        }
        largest = std::max(largest, weights[i]);
    }
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
}

DiscreteDistribution::Pick DiscreteDistribution::sample(double u) const {
    // First entry above u: an outcome of zero width can never be it.
    const auto it = std::upper_bound(cdf_.begin(), cdf_.end(), u);
    const std::size_t index = std::min(std::size_t(it - cdf_.begin()), cdf_.size() - 1);
    const double below = index == 0 ? 0.0 : cdf_[index - 1];
    return {std::uint32_t(index), cdf_[index] - below, u - below};
}

}  // namespace lacuna
