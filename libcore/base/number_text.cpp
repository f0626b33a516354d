#include "libcore/base/number_text.h"

#include <charconv>
#include <cmath>
#include <cstdint>

namespace lacuna {

std::string numberText(double value) {
    constexpr double kWhole = 1e15;
    char buffer[32];
    const bool whole = value == std::floor(value) && std::fabs(value) < kWhole;
    const auto end = whole ? std::to_chars(buffer, buffer + sizeof buffer, std::int64_t(value))
                           : std::to_chars(buffer, buffer + sizeof buffer, value);
    return {buffer, end.ptr};
}

std::optional<double> parseNumber(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
        return std::nullopt;
    }
    return value;
}

}  // namespace lacuna
