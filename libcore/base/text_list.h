// Lists in text: names in messages, parts of an option's value.
#pragma once

#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

/// The texts of a range, or its elements' projections, with `between` between them.
template <class Range, class Projection = std::identity>
std::string joined(const Range& range, std::string_view between, Projection projection = {}) {
    std::string text;
    for (auto at = std::begin(range); at != std::end(range); ++at) {
        if (at != std::begin(range)) text += between;
        text += std::invoke(projection, *at);
    }
    return text;
}

/// The parts between commas, empty ones too; at least one.
inline std::vector<std::string_view> splitAtCommas(std::string_view text) {
    std::vector<std::string_view> parts;
    for (;;) {
        const std::size_t comma = text.find(',');
        parts.push_back(text.substr(0, comma));
        if (comma == std::string_view::npos) return parts;
        text.remove_prefix(comma + 1);
    }
}

}  // namespace lacuna
