// What the page shows besides pictures, as JSON; the same goes to --json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/study/results.h"
#include "render/study/tables.h"

namespace lacuna {

/// Study, scenes, methods; per scene, method and measure the bands of all axes; means over seeds of
/// phases (seconds), rays by kind and memory (bytes); knobs; tables; all runs. What is not finite
/// is null.
nlohmann::json pageData(const Results& results, const std::vector<Table>& tables);

}  // namespace lacuna
