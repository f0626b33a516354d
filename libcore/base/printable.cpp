#include "libcore/base/printable.h"

namespace lacuna {

std::string printable(const std::string& text, std::size_t longest) {
    std::string line = text.substr(0, longest);
    for (char& c : line) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    }
    if (text.size() > longest) line += "...";
    return line;
}

}  // namespace lacuna
