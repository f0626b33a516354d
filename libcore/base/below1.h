// Random numbers that are used again.
#pragma once

namespace lacuna {

/// What is left of a random number for the next choice, in [0, 1): rounding may have made it one.
inline double below1(double u) {
    constexpr double kMost = 0x1.fffffffffffffp-1;
    return u < kMost ? u : kMost;
}

}  // namespace lacuna
