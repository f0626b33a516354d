// The files that a study leaves for people: raw CSV, tables, the page.
#pragma once

#include <string>
#include <vector>

#include "render/study/results.h"

namespace lacuna {

/// Where a report goes besides the study's folder; empty: nowhere.
struct ReportCopies {
    std::string summary;  ///< file of the tables and how they were made, as in tables.md
    std::string json;     ///< file of what the page shows
};

/// Writes them into `directory`, each atomically; returns their paths. `command` made the study.
/// Throws RunError, InputError for a run's image that cannot be read.
std::vector<std::string> writeReport(const Results& results, const std::string& directory,
                                     const std::string& command, const std::string& chartLibrary,
                                     const ReportCopies& copies);

}  // namespace lacuna
