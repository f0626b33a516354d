// Pearson's test of counts against probabilities.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "tests/material/statistics.h"

namespace lacuna::test {

/// Significance of `counts` under `probabilities` (together the mass of all samples, or less if
/// some may fall outside: then the rest is one more cell). Cells that expect fewer than ten are
/// merged. Zero where a cell of probability zero was hit.
inline double chiSquareSignificance(const std::vector<std::uint64_t>& counts,
                                    const std::vector<double>& probabilities,
                                    std::uint64_t samples) {
    std::vector<std::size_t> order(counts.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(),
              [&](auto a, auto b) { return probabilities[a] < probabilities[b]; });
    double statistic = 0, cells = 0, expected = 0, allExpected = 0, observed = 0, allObserved = 0;
    const auto close = [&] {
        statistic += (observed - expected) * (observed - expected) / expected;
        cells += 1;
        expected = observed = 0;
    };
    for (const std::size_t i : order) {
        if (!(probabilities[i] > 0)) {
            if (counts[i] > 0) return 0.0;
            continue;
        }
        expected += probabilities[i] * double(samples);
        observed += double(counts[i]);
        allExpected += probabilities[i] * double(samples);
        allObserved += double(counts[i]);
        if (expected >= 10) close();
    }
    expected += double(samples) - allExpected;
    observed += double(samples) - allObserved;
    if (expected >= 10) {
        close();
    } else if (observed > 10 * (expected + 5)) {
        return 0.0;
    }
    return cells < 2 ? 1.0 : chiSquareTail(statistic, cells - 1);
}

}  // namespace lacuna::test
