// From the study's file to the logs of all its runs: whatever is missing is rendered.
#pragma once

#include "render/study/results.h"

namespace lacuna {

struct Execution {
    Results results;
    std::size_t rendered = 0;  ///< runs that were not there before
};

/// Everything that can be wrong with scenes and references is found before the first run. Throws
/// Error 130 if interrupted; finished runs stay in `directory` and are not repeated.
Execution execute(const Study& study, const std::string& directory, const std::string& renderer,
                  const std::atomic<bool>& cancel, Progress& progress);

}  // namespace lacuna
