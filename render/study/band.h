// One line of a plot: median and range over the curves of several seeds.
#pragma once

#include <span>
#include <vector>

#include "render/study/curve.h"

namespace lacuna {

struct BandPoint {
    double x = 0.0, median = 0.0, low = 0.0, high = 0.0;
};

/// Median and range of the error over the curves, at ten x per decade. The range of x is that in
/// which every curve has a value: from the latest first row to the earliest last row. If there is
/// no such range (runs of few iterations), the result is one point: median and range of the last
/// rows at their median x. Empty without curves.
std::vector<BandPoint> band(std::span<const Curve* const> curves, Measure measure, Axis axis);

/// The largest x that all curves reach; 0 without curves.
double commonEnd(std::span<const Curve* const> curves, Axis axis);

}  // namespace lacuna
