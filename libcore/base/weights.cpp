#include "libcore/base/weights.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lacuna {

double largestWeight(std::span<const double> weights, const char* table) {
    double largest = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        if (!(weights[i] >= 0.0) || !std::isfinite(weights[i])) {
            throw std::invalid_argument(std::string(table) + ": weight " + std::to_string(i) +
                                        " is " + std::to_string(weights[i]) +
                                        ", expected a finite number >= 0");
        }
        largest = std::max(largest, weights[i]);
    }
    return largest;
}

}  // namespace lacuna
