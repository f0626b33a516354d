// The command line of lacuna-train that makes what a method asks for.
#pragma once

#include <cstdint>
#include <string>

#include "preprocess/assets.h"

namespace lacuna {

/// train.paths, of a method that is trained; else 0.
std::uint64_t trainingPaths(const Settings& settings);

/// What a message advises where something is missing that lacuna-train makes: "add --prepare, or run
/// lacuna-train ..". Without training there is no such command.
std::string trainRemedy(const AssetRequest& request);

}  // namespace lacuna
