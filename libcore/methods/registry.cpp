#include "libcore/methods/registry.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/methods/methods.h"

namespace lacuna {

std::span<const MethodRow> methods() {
    static const std::vector<MethodRow> rows = {pathTracingRow(),
                                                lightTracingRow(),
                                                bidirectionalRow(),
                                                lvcRow(),
                                                probabilisticConnectionsRow(),
                                                resamplingAwareRow(),
                                                currentSetRow(),
                                                twoStageResamplingRow(),
                                                importanceCachingRow(),
                                                skeletonRow(),
                                                subspaceRow(),
                                                subspaceQueueRow()};
    return rows;
}

const MethodRow& findMethod(const std::string& name) {
    std::string names;
    for (const MethodRow& row : methods()) {
        if (row.name == name) return row;
        names += (names.empty() ? "" : ", ") + row.name;
    }
    throw UsageError("--method: expected one of " + names + ", found '" + name +
                     "': see --list-methods");
}

namespace {

std::string rangeOf(const Parameter& p) {
    switch (p.kind) {
        case Parameter::Kind::Switch:
            return "on or off";
        case Parameter::Kind::Choice: {
            std::string text = "one of";
            for (const std::string& c : p.choices) text += " " + c;
            return text;
        }
        default:
            break;
    }
    const auto number = [](double v) {
        char buffer[32];
        return std::string(buffer, std::to_chars(buffer, buffer + 32, v).ptr);
    };
    return std::string(p.kind == Parameter::Kind::Integer ? "an integer" : "a number") + " from " +
           number(p.low) + " to " + number(p.high);
}

double parse(const Parameter& p, const std::string& text) {
    const auto refuse = [&]() -> double {
        throw UsageError("--set " + p.name + ": expected " + rangeOf(p) + ", found '" + text + "'");
    };
    if (p.kind == Parameter::Kind::Switch) {
        return text == "on" ? 1.0 : text == "off" ? 0.0 : refuse();
    }
    if (p.kind == Parameter::Kind::Choice) {
        for (std::size_t i = 0; i < p.choices.size(); ++i) {
            if (p.choices[i] == text) return double(i);
        }
        return refuse();
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !(value >= p.low) ||
        !(value <= p.high) || (p.kind == Parameter::Kind::Integer && value != std::floor(value))) {
        return refuse();
    }
    return value;
}

}  // namespace

Settings resolve(const MethodRow& row, std::span<const std::string> assignments) {
    Settings settings;
    for (const Parameter& p : row.parameters) settings.values_[p.name] = p.defaultValue;
    if (std::find(assignments.begin(), assignments.end(), "preset=paper") != assignments.end()) {
        for (const auto& [name, value] : row.paper) settings.values_.at(name) = value;
    }
    for (const std::string& assignment : assignments) {
        const std::size_t equals = assignment.find('=');
        const std::string key = assignment.substr(0, equals);
        if (equals == std::string::npos) {
            throw UsageError("--set: expected key=value, found '" + assignment + "'");
        }
        const Parameter* parameter = nullptr;
        std::string names;
        for (const Parameter& p : row.parameters) {
            if (p.name == key) parameter = &p;
            names += (names.empty() ? "" : ", ") + p.name;
        }
        if (!parameter) {
            throw UsageError("--set " + key + ": method " + row.name + " has " +
                             (names.empty() ? "no parameters" : "the parameters " + names) +
                             ": see --help-method " + row.name);
        }
        settings.values_[key] = parse(*parameter, assignment.substr(equals + 1));
    }
    return settings;
}

}  // namespace lacuna
