// The files that a study leaves for people: raw CSV, tables, the page.
#pragma once

#include <string>
#include <vector>

#include "render/study/results.h"

namespace lacuna {

/// Writes them into `directory`, each atomically; returns their paths. `json`: what the page shows
/// goes to this file as well (empty: nowhere). Throws RunError, InputError for a run's image that
/// cannot be read.
std::vector<std::string> writeReport(const Results& results, const std::string& directory,
                                     const std::string& chartLibrary, const std::string& json);

}  // namespace lacuna
