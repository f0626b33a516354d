#include "render/method_help.h"

#include <algorithm>

#include "libcore/base/number_text.h"

namespace lacuna {
namespace {

std::string rangeText(const Parameter& p) {
    switch (p.kind) {
        case Parameter::Kind::Switch:
            return "on, off";
        case Parameter::Kind::Choice: {
            std::string text;
            for (const std::string& c : p.choices) text += (text.empty() ? "" : ", ") + c;
            return text;
        }
        case Parameter::Kind::Integer:
        case Parameter::Kind::Real:
            break;
    }
    return (p.kind == Parameter::Kind::Integer ? "integer, " : "number, ") + numberText(p.low) +
           " to " + numberText(p.high);
}

std::string padded(std::string text, std::size_t width) {
    text.resize(std::max(text.size(), width), ' ');
    return text;
}

}  // namespace

std::string valueText(const Parameter& parameter, double value) {
    switch (parameter.kind) {
        case Parameter::Kind::Switch:
            return value != 0.0 ? "on" : "off";
        case Parameter::Kind::Choice:
            return parameter.choices.at(std::size_t(value));
        case Parameter::Kind::Integer:
        case Parameter::Kind::Real:
            break;
    }
    return numberText(value);
}

std::string listMethods() {
    std::size_t width = 0;
    for (const MethodRow& row : methods()) width = std::max(width, row.name.size());
    std::string text;
    for (const MethodRow& row : methods()) {
        text += padded(row.name, width + 2) + row.summary + " [" + row.reference + "]" +
                (row.biased ? " (biased: an experiment)" : "") + "\n";
    }
    return text;
}

std::string methodHelp(const MethodRow& row) {
    std::string text = row.name + ": " + row.summary + "\nreference: " + row.reference +
                       " (REFERENCES.md)\ntechniques:";
    const TechniqueSet& t = row.techniques;
    if (t.hits) text += "\n  s = 0          eye paths that run into a light";
    if (t.connects) text += "\n  s >= 1, t >= 2  eye vertices connected with light vertices";
    if (t.splats) text += "\n  t = 1          light paths seen by the lens";
    if (row.biased) text += "\nbiased: an experiment of a paper, not for pictures";
    text += "\nparameters (--set NAME=VALUE):\n";
    if (row.parameters.empty()) text += "  none\n";
    std::size_t width = 0;
    for (const Parameter& p : row.parameters) width = std::max(width, p.name.size());
    for (const Parameter& p : row.parameters) {
        const std::string standard =
            p.defaultText.empty() ? valueText(p, p.defaultValue) : p.defaultText;
        text += "  " + padded(p.name, width + 2) + p.help + "\n" + std::string(width + 4, ' ') +
                rangeText(p) + "; default " + standard + "\n";
    }
    return text;
}

}  // namespace lacuna
