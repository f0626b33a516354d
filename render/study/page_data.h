// The page's data besides pictures, as JSON, which is also the output of --json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/study/results.h"
#include "render/study/tables.h"

namespace lacuna {

/// Study, scenes, methods; for each scene, method and measure the bands of all axes; means over
/// seeds of phases (seconds), rays by kind and memory (bytes); knobs; tables; all runs. Numbers
/// that are not finite become null.
nlohmann::json pageData(const Results& results, const std::vector<Table>& tables);

}  // namespace lacuna
