// Numbers in messages, options and files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lacuna {

/// The shortest text that reads back as the same number (1e-46 is not "0.000000"). Whole numbers up
/// to 1e15 have no exponent.
std::string numberText(double value);
/// The whole text as a finite number, whatever the locale; empty where it is not one.
std::optional<double> parseNumber(std::string_view text);

}  // namespace lacuna
