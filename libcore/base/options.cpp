#include "libcore/base/options.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/base/text_list.h"

namespace lacuna {

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
            const std::string names = joined(options, ", ", &Option::name);
            throw UsageError(title + name + ": expected " +
                             (names.empty() ? "no parameter" : "one of " + names) +
                             ", found one that " + owner + " does not have");
        }
        settings[name] =
            option->checked(std::string_view(assignment).substr(equals + 1), title + name);
    }
    return settings;
}

}  // namespace lacuna
