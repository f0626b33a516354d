#include "libcore/base/printable.h"

#include <algorithm>
#include <string_view>

namespace lacuna {

namespace {

/// Length in bytes of the UTF-8 sequence at the start of the text; 0 if there is none (RFC 3629).
std::size_t sequenceLength(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    if (first < 0xC2 || first > 0xF4) return 0;
    const std::size_t length = first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    if (text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i) {
        if (byte(i) < 0x80 || byte(i) > 0xBF) return 0;
    }
    // Overlong forms, UTF-16 surrogates, and code points beyond Unicode's end.
    const bool tooLong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
    const bool none = (first == 0xED && byte(1) > 0x9F) || (first == 0xF4 && byte(1) > 0x8F);
    return tooLong || none ? 0 : length;
}

}  // namespace

std::string printable(const std::string& text, std::size_t longest) {
    std::string line;
    for (std::string_view left = text; !left.empty();) {
        const std::size_t length = sequenceLength(left), taken = std::max<std::size_t>(length, 1);
        if (line.size() + taken > longest) return line + "...";
        const auto first = static_cast<unsigned char>(left.front());
        const bool isControl = first < 0x20 || first == 0x7f;
        line += length == 0 ? "?" : isControl ? " " : left.substr(0, length);
        left.remove_prefix(taken);
    }
    return line;
}

}  // namespace lacuna
