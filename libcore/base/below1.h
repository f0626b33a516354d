// Reuse of random numbers.
#pragma once

namespace lacuna {

/// Clamps a rescaled random number to [0, 1): rounding may have made it one.
inline double below1(double u) {
    constexpr double kMost = 0x1.fffffffffffffp-1;
    return u < kMost ? u : kMost;
}

}  // namespace lacuna
