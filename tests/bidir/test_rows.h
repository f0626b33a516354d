// Two rows beside the registry's, for tests only (acceptance.md 0): they use what real methods will
// use of the two interfaces and none of the present ones does.
#pragma once

#include <vector>

#include "libcore/methods/registry.h"

namespace lacuna::test {

/// Several picks per length; picks that come out empty; s = 1 fresh, even lengths from vertices
/// that were kept from the previous iteration, odd ones from the pool. Credit: 3 for s = 1, 0.5
/// beyond.
MethodRow potpourriRow();
/// Uniform picks from the pool under a density r = hash(eye cell, light cell) mean(beta)^0.7.
MethodRow hashedDensityRow();

/// The registry's unbiased rows and the two above.
std::vector<MethodRow> allRows();

/// Settings that make a row quick on tiny pictures: few light subpaths.
std::vector<std::string> smallSettings(const MethodRow& row, int candidates);

}  // namespace lacuna::test
