// The provenance of a study's results: date, commit, machine, command, settings, time.
#pragma once

#include <string>

#include "render/study/results.h"

namespace lacuna {

/// The provenance as Markdown, with today's date. `command`: the command that made the study.
std::string provenance(const Results& results, const std::string& command);

/// The commit from which this program was built, with "+changes" if the sources differed from it;
/// "unknown" outside a repository.
std::string sourceCommit();

}  // namespace lacuna
