// What each group of techniques adds, how noisy that is, and what it costs: --techniques.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "libcore/bidir/error_estimate.h"
#include "libcore/bidir/statistics.h"

namespace lacuna {

/// A group of techniques, or what all of them share.
struct TechniqueCost {
    std::string name;       ///< "connections"; "eye walks"
    int order = 0;          ///< of the eye's end, the last one and all behind it; 0: has none
    bool technique = true;  ///< false: it makes no path by itself, and has its time alone
    double energy = 0.0;    ///< share of the picture's mean
    double variance = 0.0;  ///< of the mean over R^2 + e^2, as relmse counts it
    double share = 0.0;     ///< of the sum of all variances
    double seconds = 0.0;   ///< of threads
};

/// Techniques that added nothing and took no time are left out. `sum` has the layers of a
/// TechniqueFilm, `statistics` are of the same iterations, made by so many threads.
std::vector<TechniqueCost> techniqueCosts(const FilmSum& sum, const ErrorMeter& meter,
                                          const IterationStatistics& statistics, double threads,
                                          const ThreadPool* pool);

/// Lines for people, the last one with a line feed as well.
std::string techniqueTable(const std::vector<TechniqueCost>& costs);

/// [{"technique", "order", "energy", "variance", "variance_share", "seconds"}, ...]; what is no
/// technique has "technique" and "seconds" alone.
nlohmann::json techniqueCostsJson(const std::vector<TechniqueCost>& costs);

}  // namespace lacuna
