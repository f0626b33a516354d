// (theory.md, "Merging")
#include "libcore/bidir/merging.h"

#include <cmath>

namespace lacuna {

double mergeRadius(double first, std::uint32_t iteration) {
    constexpr double kAlpha = 0.75;
    return first * std::pow(double(iteration) + 1.0, 0.5 * (kAlpha - 1.0));
}

}  // namespace lacuna
