// --list-methods and --help-method: the registry as text.
#pragma once

#include <string>

#include "libcore/methods/registry.h"

namespace lacuna {

/// All methods, a line each: name, summary, reference.
std::string listMethods();
/// Help text of `auto`.
std::string autoHelp();
/// Help text of one method: summary, techniques, and parameters with ranges and defaults.
std::string methodHelp(const MethodRow& row);

}  // namespace lacuna
