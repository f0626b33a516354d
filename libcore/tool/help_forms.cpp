#include "libcore/tool/help_forms.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "libcore/base/error.h"

namespace lacuna {
namespace {

bool isWord(const std::string& text) {
    return !text.empty() && std::ranges::none_of(text, [](unsigned char c) {
        return std::isupper(c) || c == ':' || c == ',' || c == '=';
    });
}

}  // namespace

void addHelpForms(CLI::App& app, ValueWords words) {
    const auto print = [&app, words = std::move(words)](const std::string& form) {
        std::string text;
        if (form == "man") {
            text = manualPage(app);
        } else if (form == "bash") {
            text = bashCompletion(app, words);
        } else if (form == "zsh") {
            text = zshCompletion(app, words);
        } else {
            throw UsageError("--help-as: expected man, bash or zsh, found '" + form + "'");
        }
        text.pop_back();                     // CLI11 adds the newline
        throw CLI::CallForVersion(text, 0);  // CLI11 prints it like any help
    };
    app.add_option_function<std::string>(
           "--help-as", print, "Print this as a manual page, or as completion for a shell")
        ->type_name("man|bash|zsh");
}

std::vector<std::string> namesOf(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames()) names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
    return names;
}

std::string typeOf(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    return option.get_positional() && type == "TEXT" ? option.get_name() : type;
}

ValueKind valueKind(const CLI::Option& option, const ValueWords& words) {
    using Of = ValueKind::Of;
    if (option.get_items_expected_max() == 0) return {Of::Nothing};
    for (const std::string& name : namesOf(option)) {
        const auto known = words.byOption.find(name);
        if (known != words.byOption.end()) return {Of::Words, known->second};
    }
    const std::string type = typeOf(option);
    if (type == "DIR") return {Of::Folders};
    if (type == "FILE" || (option.get_positional() && type == option.get_name()))
        return {Of::Files};
    if (type == "SCENE.glb") return {Of::Files, {"glb", "gltf"}};
    if (const auto point = type.rfind('.'); point != std::string::npos) {
        return {Of::Files, {type.substr(point + 1)}};
    }
    ValueKind kind{Of::Words};
    for (const std::string& word : CLI::detail::split(type, '|')) {
        if (isWord(word)) kind.list.push_back(word);
    }
    return kind.list.empty() ? ValueKind{} : kind;
}

}  // namespace lacuna
