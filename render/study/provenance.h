// How a study's results were made: day, commit, machine, command, settings, time.
#pragma once

#include <string>

#include "render/study/results.h"

namespace lacuna {

/// As Markdown, today's date in it. `command` made the study.
std::string provenance(const Results& results, const std::string& command);

/// The commit that this program was built from, "+changes" where its sources differed from it;
/// "unknown" outside a repository.
std::string sourceCommit();

}  // namespace lacuna
