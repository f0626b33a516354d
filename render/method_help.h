// --list-methods and --help-method: the registry as text.
#pragma once

#include <string>

#include "libcore/methods/registry.h"

namespace lacuna {

/// All methods, a line each: name, summary, reference.
std::string listMethods();
/// What `auto` does.
std::string autoHelp();
/// One method: what it is, which techniques it has, its parameters with ranges and defaults.
std::string methodHelp(const MethodRow& row);

}  // namespace lacuna
