// A run's curve, as logged by lacuna-render, and its interpolation, which never extrapolates.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lacuna {

enum class Measure { Mae, Rmse, Mape, Relmse };
/// The measure of that name. Throws std::out_of_range for other names.
Measure measureOf(const std::string& name);

struct CurvePoint {
    double iteration = 0.0;
    double seconds = 0.0;  ///< without setup
    double setupSeconds = 0.0;
    double errors[4] = {};  ///< by Measure
    double error(Measure m) const { return errors[std::size_t(m)]; }
};

struct Curve {
    std::string header;              ///< the file's header line
    std::vector<std::string> lines;  ///< one per point
    std::vector<CurvePoint> points;
};

/// Reads a curve. Throws InputError for a file that lacuna-render did not write with --reference.
Curve readCurve(const std::string& path);

/// The abscissa along which a curve is evaluated.
enum class Axis { Seconds, SecondsWithSetup, Iterations };
double abscissa(const CurvePoint& point, Axis axis);

/// The first time after which the error stays below `bound`, interpolated in log-log between the
/// rows around it; none if the last row is not below. If all rows are below, it is the first row's
/// time: the bound was reached then or before.
std::optional<double> timeToError(std::span<const CurvePoint> points, Measure measure, double bound,
                                  Axis axis);

/// The error at `x`, interpolated in log-log; none outside the rows.
std::optional<double> errorAt(std::span<const CurvePoint> points, Measure measure, double x,
                              Axis axis);

}  // namespace lacuna
