#include "render/study/curve.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "libcore/base/error.h"

namespace lacuna {
namespace {

std::vector<std::string> columns(const std::string& line) {
    std::vector<std::string> all;
    std::istringstream in(line);
    for (std::string column; std::getline(in, column, ',');) all.push_back(column);
    return all;
}

/// y at x on the straight line through two points in log-log; the second point's y if a logarithm
/// does not exist.
double interpolate(double x0, double y0, double x1, double y1, double x) {
    if (!(x0 > 0.0) || !(y0 > 0.0) || !(y1 > 0.0) || !(x1 > x0) || !std::isfinite(y0)) return y1;
    const double t = std::log(x / x0) / std::log(x1 / x0);
    return y0 * std::pow(y1 / y0, t);
}

}  // namespace

Measure measureOf(const std::string& name) {
    static const std::map<std::string, Measure> kByName = {{"mae", Measure::Mae},
                                                           {"rmse", Measure::Rmse},
                                                           {"mape", Measure::Mape},
                                                           {"relmse", Measure::Relmse}};
    return kByName.at(name);
}

Curve readCurve(const std::string& path) {
    std::ifstream in(path);
    Curve curve;
    std::getline(in, curve.header);
    const std::vector<std::string> names = columns(curve.header);
    const auto fail = [&](const std::string& found) {
        throw InputError(path +
                         ": expected a curve of lacuna-render --log with --reference, found " +
                         found + "; remove its folder to run it again");
    };
    if (names.size() < 8 || names[7] != "relmse") fail("another file");
    for (std::string line; std::getline(in, line);) {
        const std::vector<std::string> row = columns(line);
        if (row.size() < 8) fail("a line that is cut off");
        const auto number = [&](std::size_t column) {
            char* end = nullptr;
            const double value = std::strtod(row[column].c_str(), &end);
            if (row[column].empty() || *end != '\0') fail("'" + row[column] + "' as a number");
            return value;
        };
        curve.points.push_back(
            {number(0), number(1), number(2), {number(4), number(5), number(6), number(7)}});
        curve.lines.push_back(line);
    }
    if (curve.points.empty()) fail("no rows");
    return curve;
}

double abscissa(const CurvePoint& point, Axis axis) {
    switch (axis) {
        case Axis::Seconds:
            return point.seconds;
        case Axis::SecondsWithSetup:
            return point.seconds + point.setupSeconds;
        case Axis::Iterations:
            break;
    }
    return point.iteration;
}

std::optional<double> timeToError(std::span<const CurvePoint> points, Measure measure, double bound,
                                  Axis axis) {
    std::size_t below = points.size();  // first of the trailing rows that are all below
    while (below > 0 && points[below - 1].error(measure) < bound) --below;
    if (below == points.size()) return std::nullopt;
    const double reached = abscissa(points[below], axis);
    if (below == 0) return reached;
    const CurvePoint &before = points[below - 1], &after = points[below];
    // The inverse of errorAt: interpolates the time as a function of the error.
    const double e0 = before.error(measure), e1 = after.error(measure);
    if (!std::isfinite(e0) || !(e1 > 0.0)) return reached;
    const double t = std::log(bound / e0) / std::log(e1 / e0);
    const double x0 = abscissa(before, axis);
    return x0 * std::pow(reached / x0, t);
}

std::optional<double> errorAt(std::span<const CurvePoint> points, Measure measure, double x,
                              Axis axis) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double here = abscissa(points[i], axis);
        if (here < x) continue;
        if (here == x) return points[i].error(measure);
        if (i == 0) return std::nullopt;
        return interpolate(abscissa(points[i - 1], axis), points[i - 1].error(measure), here,
                           points[i].error(measure), x);
    }
    return std::nullopt;
}

}  // namespace lacuna
