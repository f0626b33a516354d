// Medians with ranges over seeds, where some runs may not have reached what is asked for.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lacuna {

/// Of n values, those that are none count as beyond all others: a median among them is none.
struct Spread {
    std::optional<double> median, low, high;
    std::size_t reached = 0, of = 0;
};

Spread spread(std::span<const std::optional<double>> values);

/// a[i] / b[i], none where either is: ratios are paired within a seed, then their median is taken.
std::vector<std::optional<double>> ratios(std::span<const std::optional<double>> a,
                                          std::span<const std::optional<double>> b);

/// "1.23 (1.1 to 1.4)", "1.23" for a single value, "1.23 (1.1 to not reached)", "not reached (1 of
/// 3 seeds)".
std::string spreadText(const Spread& spread);
/// Three significant digits.
std::string shortNumber(double value);

}  // namespace lacuna
