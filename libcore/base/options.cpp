#include "libcore/base/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libcore/base/error.h"

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

std::string Option::range() const {
    switch (kind) {
        case Kind::Switch:
            return "on or off";
        case Kind::Text:
            return "a text";
        case Kind::Choice: {
            std::string text = "one of";
            for (const std::string& c : choices) text += " " + c;
            return text;
        }
        case Kind::Integer:
        case Kind::Real:
            break;
    }
    return std::string(kind == Kind::Integer ? "an integer" : "a number") + " from " +
           numberText(low) + " to " + numberText(high);
}

std::string Option::checked(std::string_view value, const std::string& title) const {
    const auto refuse = [&] {
        throw UsageError(title + ": expected " + range() + ", found '" + std::string(value) + "'");
    };
    if (kind == Kind::Text) return std::string(value);
    if (kind == Kind::Switch || kind == Kind::Choice) {
        const bool known = kind == Kind::Switch
                               ? value == "on" || value == "off"
                               : std::find(choices.begin(), choices.end(), value) != choices.end();
        if (!known) refuse();
        return std::string(value);
    }
    const std::optional<double> number = parseNumber(value);
    const bool good = number && *number >= low && *number <= high &&
                      (kind == Kind::Real || *number == std::floor(*number));
    if (!good) refuse();
    return numberText(*number);
}

Settings resolveOptions(std::span<const Option> options, std::span<const std::string> assignments,
                        const std::string& owner, const std::string& title) {
    Settings settings;
    for (const Option& o : options) settings[o.name] = o.standard;
    for (const std::string& assignment : assignments) {
        const std::size_t equals = assignment.find('=');
        if (equals == std::string::npos) {
            throw UsageError(title + "expected name=value, found '" + assignment + "'");
        }
        const std::string name = assignment.substr(0, equals);
        const auto option = std::find_if(options.begin(), options.end(),
                                         [&](const Option& o) { return o.name == name; });
        if (option == options.end()) {
            std::string names;
            for (const Option& o : options) names += (names.empty() ? "" : ", ") + o.name;
            throw UsageError(title + name + ": " + owner + " has " +
                             (names.empty() ? "no parameters" : "the parameters " + names));
        }
        settings[name] =
            option->checked(std::string_view(assignment).substr(equals + 1), title + name);
    }
    return settings;
}

}  // namespace lacuna
