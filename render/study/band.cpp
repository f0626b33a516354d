#include "render/study/band.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/study/spread.h"

namespace lacuna {
namespace {

constexpr double kPerDecade = 10.0;

/// The ends and, between them, the multiples of a tenth of a decade.
std::vector<double> grid(double low, double high) {
    std::vector<double> xs{low};
    const double first = std::floor(kPerDecade * std::log10(low)) + 1.0;
    for (double i = first;; i += 1.0) {
        const double x = std::pow(10.0, i / kPerDecade);
        if (!(x < high)) break;
        if (x > low) xs.push_back(x);
    }
    if (high > low) xs.push_back(high);
    return xs;
}

/// Median and range at x. An infinite error (mape against a black reference) stays infinite.
BandPoint pointOf(double x, std::span<const std::optional<double>> errors) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    const Spread s = spread(errors);
    return {x, s.median.value_or(kInfinite), s.low.value_or(kInfinite), s.high.value_or(kInfinite)};
}

}  // namespace

double commonEnd(std::span<const Curve* const> curves, Axis axis) {
    double end = 0.0;
    for (const Curve* curve : curves) {
        const double last = abscissa(curve->points.back(), axis);
        end = end == 0.0 ? last : std::min(end, last);
    }
    return end;
}

std::vector<BandPoint> band(std::span<const Curve* const> curves, Measure measure, Axis axis) {
    if (curves.empty()) return {};
    double begin = 0.0;
    for (const Curve* curve : curves) {
        begin = std::max(begin, abscissa(curve->points.front(), axis));
    }
    const double end = commonEnd(curves, axis);
    std::vector<std::optional<double>> errors(curves.size());
    if (!(begin > 0.0) || begin > end) {
        std::vector<std::optional<double>> xs(curves.size());
        for (std::size_t i = 0; i < curves.size(); ++i) {
            xs[i] = abscissa(curves[i]->points.back(), axis);
            errors[i] = curves[i]->points.back().error(measure);
        }
        return {pointOf(spread(xs).median.value(), errors)};
    }
    std::vector<BandPoint> points;
    for (const double x : grid(begin, end)) {
        for (std::size_t i = 0; i < curves.size(); ++i) {
            errors[i] = errorAt(curves[i]->points, measure, x, axis);
        }
        points.push_back(pointOf(x, errors));
    }
    return points;
}

}  // namespace lacuna
