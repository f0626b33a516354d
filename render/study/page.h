// index.html: everything that a study found, in one file that opens without server or network.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lacuna {

/// Chart.js as its package installed it. Throws RunError that names the package.
std::string readChartLibrary();

/// The page around `data` (see pageData) and `pictures` (see picturesJson).
std::string pageHtml(const std::string& title, const std::string& chartLibrary,
                     const nlohmann::json& data, const nlohmann::json& pictures);

}  // namespace lacuna
