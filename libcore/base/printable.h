// Text of foreign files in messages.
#pragma once

#include <cstddef>
#include <string>

namespace lacuna {

/// Text of a file's own (names, URIs, what libraries say of them) made safe for one line of a terminal:
/// control characters become blanks, what is no UTF-8 question marks, and text beyond `longest` bytes is cut
/// between two characters.
std::string printable(const std::string& text, std::size_t longest = 120);

}  // namespace lacuna
