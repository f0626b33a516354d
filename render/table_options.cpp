#include "render/table_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

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

std::string optionName(const Option& option) {
    std::string name = "--" + option.name;
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

OptionTexts::OptionTexts(CLI::App& app, std::vector<Option> options)
    : options_(std::move(options)) {
    for (const Option& o : options_) {
        const std::string standard = o.standardText.empty() ? o.standard : o.standardText;
        std::string help = o.unit.empty() ? o.help : o.unit + " " + o.help;
        help[0] = char(std::toupper(static_cast<unsigned char>(help[0])));
        app.add_option(optionName(o), texts_.emplace_back(o.standard),
                       help + " (" + o.range() + "; default: " + standard + ")")
            ->type_name(typeName(o.kind));
    }
}

Settings OptionTexts::settings() const {
    Settings settings;
    for (std::size_t i = 0; i < options_.size(); ++i) {
        settings[options_[i].name] = options_[i].checked(texts_[i], optionName(options_[i]));
    }
    return settings;
}

}  // namespace lacuna
