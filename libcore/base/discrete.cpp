#include "libcore/base/discrete.h"

#include <algorithm>

#include "libcore/base/weights.h"

namespace lacuna {

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights) {
    const double largest = largestWeight(weights, "discrete distribution");
    cdf_.resize(weights.size() + 1);
    if (largest == 0.0) return;

    // Relative to the largest weight, so that the sum neither overflows nor goes denormal.
    const std::span<double> ends = std::span(cdf_).subspan(1);
    double sum = 0.0;
    std::size_t lastPositive = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += weights[i] / largest;
        ends[i] = sum;
        if (weights[i] > 0.0) lastPositive = i;
    }
    for (std::size_t i = 0; i < lastPositive; ++i) ends[i] = std::min(ends[i] / sum, 1.0);
    for (std::size_t i = lastPositive; i < ends.size(); ++i) ends[i] = 1.0;
    total_ = sum * largest;

    guide_.reserve(ends.size() + 1);
    for (std::size_t k = 0, i = 0; k < ends.size(); ++k) {
        while (bucket(ends[i]) < k) ++i;  // terminates: the last entry is one
        guide_.push_back(std::uint32_t(i));
    }
    guide_.push_back(std::uint32_t(lastPositive));
}

}  // namespace lacuna
