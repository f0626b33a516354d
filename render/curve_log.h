// Error against time, row by row: the file is whole after each of them, whatever happens.
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
    std::uint64_t iteration = 0;  ///< complete ones
    double seconds = 0.0;         ///< rendering alone: no setup, no comparing, no saving
    double setupSeconds = 0.0;
    RayCounts rays{};
    std::optional<ErrorMeasures> error;          ///< empty columns without
    std::map<std::string, double> phaseSeconds;  ///< of the iterations so far, by name
};

/// CSV: iteration,seconds,setup_seconds,rays,mae,rmse,mape,relmse, then rays_KIND per kind of ray
/// and `phases`, which is name=seconds;name=seconds (methods have phases of their own, so they are
/// not columns). The first and the last iteration have a row, and at most ten iterations per decade
/// of seconds in between.
class CurveLog {
  public:
    /// Replaces the file by its header line and its rows up to `iteration`, if they are there: a
    /// render that goes on from a checkpoint. Throws RunError.
    explicit CurveLog(const std::string& path, std::uint64_t iteration = 0);

    /// Whether an iteration that ended at `seconds` gets a row: asked once per iteration, before
    /// its error is measured.
    bool wants(double seconds);
    /// Throws RunError if the row did not reach the file.
    void write(const CurveRow& row);
    /// Iteration of the last row; 0: none yet.
    std::uint64_t lastIteration() const { return lastIteration_; }

  private:
    void append(const std::string& line);
    void writeAll();

    std::string path_;
    bool isFile_ = true;  ///< else a pipe or a device, which takes each line once
    std::string text_;    ///< of the file
    std::ofstream device_;
    std::optional<int> lastTenth_;  // floor(10 log10 seconds)
    std::uint64_t lastIteration_ = 0;
};

}  // namespace lacuna
