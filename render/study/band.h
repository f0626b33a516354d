// One line of a plot: the curves of several seeds as a median with its range.
#pragma once

#include <span>
#include <vector>

#include "render/study/curve.h"

namespace lacuna {

struct BandPoint {
    double x = 0.0, median = 0.0, low = 0.0, high = 0.0;
};

/// The error at x, over the curves, at ten x per decade where every curve has a value: from the
/// latest of the first rows to the earliest of the last. Where no such range exists (runs of few
/// iterations) there is one point, median and range of the last rows at their median x. Empty
/// without curves.
std::vector<BandPoint> band(std::span<const Curve* const> curves, Measure measure, Axis axis);

/// The largest x that all curves have; 0 without curves.
double commonEnd(std::span<const Curve* const> curves, Axis axis);

}  // namespace lacuna
