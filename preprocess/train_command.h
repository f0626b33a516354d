// The command line of lacuna-train that makes the assets of a method.
#pragma once

#include <cstdint>
#include <string>

#include "preprocess/assets.h"

namespace lacuna {

/// The setting train.paths; 0 for methods without training.
std::uint64_t trainingPaths(const Settings& settings);

/// The advice in a message if an asset of lacuna-train is missing: "add --prepare, or run
/// lacuna-train ..". The command is left out for methods without training.
std::string trainRemedy(const AssetRequest& request);

}  // namespace lacuna
