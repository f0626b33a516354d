// Which build it is that renders: programs are small, the library has the code.
#pragma once

#include <string>

namespace lacuna {

/// The path of the file that holds the code which renders: the library, or a program that it is
/// linked into.
std::string codeFile();

}  // namespace lacuna
