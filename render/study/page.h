// index.html: all results of a study in one file that needs no server or network.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lacuna {

/// The source of Chart.js as installed by its package. Throws RunError, which names the package, if
/// it is missing.
std::string readChartLibrary();

/// The page with `data` (see pageData) and `pictures` (see picturesJson).
std::string pageHtml(const std::string& title, const std::string& chartLibrary,
                     const nlohmann::json& data, const nlohmann::json& pictures);

}  // namespace lacuna
