// Text from foreign files in messages.
#pragma once

#include <cstddef>
#include <string>

namespace lacuna {

/// Makes text from a file (names, URIs, libraries' messages about it) safe for one line of a terminal. Control
/// characters become blanks, invalid UTF-8 becomes question marks, and text beyond `longest` bytes is cut between two
/// characters.
std::string printable(const std::string& text, std::size_t longest = 120);

}  // namespace lacuna
