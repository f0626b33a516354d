// What tables of weights ask of them before anything else.
#pragma once

#include <span>

namespace lacuna {

/// The largest weight, zero for none. Throws std::invalid_argument naming the first that is
/// negative or not finite; `table` begins the message.
double largestWeight(std::span<const double> weights, const char* table);

}  // namespace lacuna
