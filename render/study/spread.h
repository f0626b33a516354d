// Medians and ranges over seeds, some of which may have no value because a bound was not reached.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lacuna {

/// Median and range of n values. Missing values count as larger than all others; a median may be
/// missing.
struct Spread {
    std::optional<double> median, low, high;
    std::size_t reached = 0, of = 0;
};

Spread spread(std::span<const std::optional<double>> values);

/// a[i] / b[i]; missing if either is. Ratios are paired within a seed before their median is taken.
std::vector<std::optional<double>> ratios(std::span<const std::optional<double>> a,
                                          std::span<const std::optional<double>> b);

/// "1.23 (1.1 to 1.4)", "1.23" for a single value, "1.23 (1.1 to not reached)", "not reached (1 of
/// 3 seeds)".
std::string spreadText(const Spread& spread);
/// Three significant digits.
std::string shortNumber(double value);

}  // namespace lacuna
