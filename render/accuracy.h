// The cost of accuracy: --until, --estimate, and the progress line's text about it.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "libcore/bidir/error_estimate.h"

namespace lacuna {

/// `--until MEASURE=E`.
struct UntilRequest {
    std::string measure;  ///< mape, relmse, rmse
    double error = 0.0;
};

/// Parses MEASURE=E. Throws UsageError.
UntilRequest parseUntil(const std::string& text);

/// A picture's error after a time of rendering.
struct ErrorNow {
    std::string measure;
    double error = 0.0;
    double seconds = 0.0;  ///< of rendering
    bool doubtful = false;

    /// Seconds of rendering, from its beginning, until the error is at most `bound`. Errors are
    /// inversely proportional to the root of the time, squared errors to the time.
    double secondsTo(double bound) const;
    /// The predicted error after further rendering.
    ErrorNow after(double moreSeconds) const;
};

/// "mape 4.1 %, 2 % in 3m05s": the current error, and the remaining time until the next round
/// figure, or until `bound` (0: none) if that comes first.
std::string accuracyText(const ErrorNow& now, double bound);

/// The result of --estimate.
struct AccuracyCost {
    std::string scene, method;
    int width = 0, height = 0;
    std::uint64_t iterations = 0;
    double setupSeconds = 0.0;
    ErrorNow now;
    std::string doubt;  ///< why the estimate is doubtful; empty: it is not
};

/// The table of --estimate: errors from 20 % to 1 %, and the time to reach each.
std::string costTable(const AccuracyCost& cost);
/// {"mape", "seconds", "promised", "costs": [{"mape", "seconds"}, ...]}
nlohmann::json costJson(const AccuracyCost& cost);

}  // namespace lacuna
