// Executes a study: renders all missing runs and collects their logs.
#pragma once

#include "render/study/results.h"

namespace lacuna {

struct Execution {
    Results results;
    std::size_t rendered = 0;  ///< number of runs rendered now
};

/// Reports all errors of scenes and references before the first run. Throws InterruptedError if
/// interrupted; finished runs stay in `directory` and are not repeated.
Execution execute(const Study& study, const std::string& directory, const std::string& renderer,
                  const std::atomic<bool>& cancel, Progress& progress);

}  // namespace lacuna
