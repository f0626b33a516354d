// A log of error against time. The file is complete after each row.
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include "libcore/image/error_metrics.h"
#include "libcore/scene/ray.h"

namespace lacuna {

struct CurveRow {
    std::uint64_t iteration = 0;  ///< number of complete iterations
    double seconds = 0.0;         ///< rendering only: no setup, comparing or saving
    double setupSeconds = 0.0;
    RayCounts rays{};
    std::optional<ErrorMeasures> error;          ///< columns are empty without it
    std::map<std::string, double> phaseSeconds;  ///< of the iterations so far, by name
};

/// CSV: iteration,seconds,setup_seconds,rays,mae,rmse,mape,relmse, then rays_KIND per kind of ray
/// and `phases`, which is name=seconds;name=seconds (methods have phases of their own, so that
/// these are not columns). The first and the last iteration have a row, and in between at most ten
/// iterations per decade of seconds.
class CurveLog {
  public:
    /// Truncates the file to its header line and its rows up to `iteration`, if there are any: a
    /// render that continues from a checkpoint keeps them. Throws RunError.
    explicit CurveLog(const std::string& path, std::uint64_t iteration = 0);

    /// Whether an iteration that ended at `seconds` gets a row. To be called once per iteration,
    /// before its error is measured.
    bool wants(double seconds);
    /// Writes a row. Throws RunError if it did not reach the file.
    void write(const CurveRow& row);
    /// Iteration of the last row; 0: none yet.
    std::uint64_t lastIteration() const { return lastIteration_; }

  private:
    void append(const std::string& line);
    void writeAll();

    std::string path_;
    bool isFile_ = true;  ///< false: a pipe or a device, which gets each line once
    std::string text_;    ///< content of the file
    std::ofstream device_;
    std::optional<int> lastTenth_;  // floor(10 log10 seconds)
    std::uint64_t lastIteration_ = 0;
};

}  // namespace lacuna
