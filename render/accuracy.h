// What accuracy costs: --until, --estimate, and what the progress line says of it.
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

/// Throws UsageError.
UntilRequest parseUntil(const std::string& text);

/// A picture's error after so much time.
struct ErrorNow {
    std::string measure;
    double error = 0.0;
    double seconds = 0.0;  ///< of rendering
    bool doubtful = false;

    /// Of rendering, from its beginning on: errors fall by the root of the time, squares with it.
    double secondsTo(double bound) const;
    /// After more iterations of the same kind.
    ErrorNow after(double moreSeconds) const;
};

/// "mape 4.1 %, 2 % in 3m05s": the error now, and the time that is left to the next round figure,
/// or to `bound` (0: none) where that comes first.
std::string accuracyText(const ErrorNow& now, double bound);

/// What --estimate found.
struct AccuracyCost {
    std::string scene, method;
    int width = 0, height = 0;
    std::uint64_t iterations = 0;
    double setupSeconds = 0.0;
    ErrorNow now;
    std::string doubt;  ///< why nothing can be promised; empty: it can
};

/// The table of --estimate: errors from 20 % to 1 %, and the seconds to each.
std::string costTable(const AccuracyCost& cost);
/// {"mape", "seconds", "promised", "costs": [{"mape", "seconds"}, ...]}
nlohmann::json costJson(const AccuracyCost& cost);

}  // namespace lacuna
