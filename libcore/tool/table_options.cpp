#include "libcore/tool/table_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "libcore/tool/tool.h"

namespace lacuna {
namespace {

const char* typeName(Option::Kind kind) {
    switch (kind) {
        case Option::Kind::Integer:
            return "N";
        case Option::Kind::Real:
            return "X";
        case Option::Kind::Switch:
            return "on|off";
        case Option::Kind::Choice:
            return "NAME";
        case Option::Kind::Text:
            break;
    }
    return "TEXT";
}

}  // namespace

std::string optionName(const std::string& name) {
    std::string text = "--" + name;
    std::replace(text.begin(), text.end(), '_', '-');
    return text;
}

std::string optionArguments(const Settings& settings) {
    std::string text;
    for (const auto& [name, value] : settings) {
        text += " " + optionName(name) + " " + shellQuoted(value);
    }
    return text;
}

OptionTexts::OptionTexts(CLI::App& app, std::vector<Option> options)
    : options_(std::move(options)) {
    for (const Option& o : options_) {
        std::string help = o.meaning();
        help[0] = char(std::toupper(static_cast<unsigned char>(help[0])));
        app.add_option(optionName(o.name), texts_.emplace_back(o.standard),
                       help + " (" + o.range() + "; default: " + o.shownDefault() + ")")
            ->type_name(typeName(o.kind));
    }
}

Settings OptionTexts::settings() const {
    Settings settings;
    for (std::size_t i = 0; i < options_.size(); ++i) {
        settings[options_[i].name] = options_[i].checked(texts_[i], optionName(options_[i].name));
    }
    return settings;
}

}  // namespace lacuna
