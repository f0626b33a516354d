// The check of weights that every table of weights begins with.
#pragma once

#include <span>

namespace lacuna {

/// The largest weight, or zero if there are none. Throws std::invalid_argument naming the first
/// weight that is negative or not finite; the message begins with `table`.
double largestWeight(std::span<const double> weights, const char* table);

}  // namespace lacuna
