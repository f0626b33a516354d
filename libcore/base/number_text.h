// Numbers in messages.
#pragma once

#include <charconv>
#include <string>

namespace lacuna {

/// The shortest text that reads back as `value`: 1e-46 is not "0.000000".
inline std::string numberText(double value) {
    char buffer[32];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

}  // namespace lacuna
