// Identifies the build that renders: programs are small, and the library contains the code.
#pragma once

#include <string>

namespace lacuna {

/// The path of the file with the rendering code: the shared library, or the program into which it
/// is linked.
std::string codeFile();

}  // namespace lacuna
