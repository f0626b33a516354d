// --techniques: contribution, noise and cost of each group of techniques.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "libcore/bidir/error_estimate.h"
#include "libcore/bidir/statistics.h"

namespace lacuna {

/// A group of techniques, or work that all of them share.
struct TechniqueCost {
    std::string name;       ///< "connections"; "eye walks"
    int order = 0;          ///< order of the eye's end, the last including all later ones; 0: none
    bool technique = true;  ///< false: shared work, which makes no paths and has only a time
    double energy = 0.0;    ///< share of the picture's mean
    double variance = 0.0;  ///< mean of variance / (R^2 + e^2), as in relmse
    double share = 0.0;     ///< share of the sum of all variances
    double seconds = 0.0;   ///< summed over threads
};

/// The costs of all techniques that contributed or took time. `sum` must have the layers of a
/// TechniqueFilm; `statistics` are of the same iterations, which `threads` threads made.
std::vector<TechniqueCost> techniqueCosts(const FilmSum& sum, const ErrorMeter& meter,
                                          const IterationStatistics& statistics, double threads,
                                          const ThreadPool* pool);

/// The table as text; each line ends with a line feed.
std::string techniqueTable(const std::vector<TechniqueCost>& costs);

/// [{"technique", "order", "energy", "variance", "variance_share", "seconds"}, ...]. Shared work
/// has only "technique" and "seconds".
nlohmann::json techniqueCostsJson(const std::vector<TechniqueCost>& costs);

}  // namespace lacuna
