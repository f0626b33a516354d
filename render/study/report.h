// The files of a study's report: raw CSV, tables, the page.
#pragma once

#include <string>
#include <vector>

#include "render/study/results.h"

namespace lacuna {

/// Additional copies of a report outside the study's folder; empty: none.
struct ReportCopies {
    std::string summary;  ///< file with the content of tables.md
    std::string json;     ///< file with the page's data
};

/// Writes the report's files to `directory`, each atomically, and returns their paths. `command`:
/// the command that made the study. Throws RunError, and InputError for a run's image that cannot
/// be read.
std::vector<std::string> writeReport(const Results& results, const std::string& directory,
                                     const std::string& command, const std::string& chartLibrary,
                                     const ReportCopies& copies);

}  // namespace lacuna
