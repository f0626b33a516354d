#include "render/study/spread.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace lacuna {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

std::optional<double> reachedOnly(double value) {
    return value == kNever ? std::nullopt : std::optional(value);
}

}  // namespace

Spread spread(std::span<const std::optional<double>> values) {
    Spread s;
    s.of = values.size();
    if (values.empty()) return s;
    std::vector<double> sorted;
    for (const std::optional<double>& v : values) sorted.push_back(v.value_or(kNever));
    std::sort(sorted.begin(), sorted.end());
    s.reached =
        std::size_t(std::lower_bound(sorted.begin(), sorted.end(), kNever) - sorted.begin());
    const std::size_t n = sorted.size();
    s.median = reachedOnly(0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]));
    s.low = reachedOnly(sorted.front());
    s.high = reachedOnly(sorted.back());
    return s;
}

std::vector<std::optional<double>> ratios(std::span<const std::optional<double>> a,
                                          std::span<const std::optional<double>> b) {
    std::vector<std::optional<double>> all(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i] && b[i] && *b[i] > 0.0) all[i] = *a[i] / *b[i];
    }
    return all;
}

std::string shortNumber(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

std::string spreadText(const Spread& s) {
    if (!s.median) {
        return "not reached" + (s.reached == 0 ? std::string()
                                               : " (" + std::to_string(s.reached) + " of " +
                                                     std::to_string(s.of) + " seeds)");
    }
    if (s.of == 1) return shortNumber(*s.median);
    return shortNumber(*s.median) + " (" + shortNumber(*s.low) + " to " +
           (s.high ? shortNumber(*s.high) : "not reached") + ")";
}

}  // namespace lacuna
