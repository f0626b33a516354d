// Completion for bash and zsh. Each script is a table of the program's options and a few lines of
// shell that read it. The table tells whether an option takes no value, a file, or one of a list of
// words.
#include <CLI/CLI.hpp>
#include <algorithm>

#include "libcore/base/text_list.h"
#include "libcore/tool/help_forms.h"
#include "libcore/tool/tool.h"

namespace lacuna {
namespace {

using Of = ValueKind::Of;

constexpr const char* kBashReader =
    R"shell(# Reads options, values and settings of the function that calls it.
_lacuna_complete() {
    # Readline parts words at =. Here --option=value and key=value are one word each.
    local words=() part glued='' i
    for ((i = 1; i <= COMP_CWORD; ++i)); do
        part=${COMP_WORDS[i]}
        if ((${#words[@]})) && [[ $part == = || $glued ]]; then
            words[-1]+=$part
        else
            words+=("$part")
        fi
        [[ $part == = ]] && glued=1 || glued=''
    done
    local whole=${words[-1]} value=${words[-1]} option=''
    ((${#words[@]} < 2)) || option=${words[-2]}

    local kind=${values[ARGUMENT]-}
    if [[ $value == --*=* ]]; then
        option=${value%%=*} value=${value#*=} kind=${values[${whole%%=*}]-}
    elif [[ $option == -* && -n ${values[$option]+there} ]]; then
        kind=${values[$option]}
    elif [[ $value == -* ]]; then
        kind=$options option=''
    else
        option=''
    fi
    if [[ $option == --set ]]; then
        local method=auto
        for ((i = 0; i < ${#words[@]}; ++i)); do
            case ${words[i]} in
                --method) method=${words[i + 1]-} ;;
                --method=*) method=${words[i]#*=} ;;
            esac
        done
        [[ -z $method ]] || kind=${settings[$method]-}
    fi

    local found=() candidate
    case $kind in
        /*) mapfile -t found < <(compgen -d -- "$value") ;;&
        /file*)
            while read -r candidate; do
                [[ ! -d $candidate ]] || continue
                [[ $kind == /file || " ${kind#/file } " == *" ${candidate##*.} "* ]] &&
                    found+=("$candidate")
            done < <(compgen -f -- "$value")
            ;;&
        /*) compopt -o filenames 2>/dev/null ;;
        *)
            for candidate in $kind; do
                [[ $candidate == "$value"* ]] || continue
                # A key first, its values once it is there.
                [[ $value == *=* || $candidate != *=* ]] || candidate=${candidate%%=*}=
                [[ " ${found[*]} " == *" $candidate "* ]] || found+=("$candidate")
            done
            [[ ${found[*]} != *= ]] || compopt -o nospace 2>/dev/null
            ;;
    esac

    # What readline replaces begins behind the last =.
    local before=${whole%"$value"} kept=''
    [[ $value != *=* || $kind == /* ]] || before+=${value%=*}=
    [[ $COMP_WORDBREAKS == *=* ]] || kept=${whole%"$value"}
    COMPREPLY=()
    for candidate in "${found[@]}"; do
        if [[ $COMP_WORDBREAKS == *=* && $value == *=* ]]; then
            candidate=${candidate#"${value%=*}="}
        fi
        COMPREPLY+=("$kept$candidate")
    done
}
)shell";

constexpr const char* kZshReader = R"shell(_lacuna_words() {
    local -a keys=(${(M)@:#*=}) words=(${@:#*=})
    compadd -S '' -a keys
    compadd -a words
}
)shell";

/// The name of the program as that of a shell function.
std::string functionName(const CLI::App& app) {
    std::string name = "_" + app.get_name();
    std::ranges::replace(name, '-', '_');
    return name;
}

bool isShown(const CLI::Option& option) {
    return !option.get_group().empty();
}

/// The kind of value in the notation of kBashReader.
std::string bashKind(const ValueKind& kind) {
    if (kind.of == Of::Folders) return "/folder";
    if (kind.of == Of::Files)
        return "/file" + (kind.list.empty() ? "" : " " + joined(kind.list, " "));
    return joined(kind.list, " ");
}

/// One entry of an associative array.
std::string bashRow(const std::string& key, const std::string& value) {
    return "        [" + key + "]=" + shellQuoted(value) + "\n";
}

/// zsh's action for a value. `settings`: the value is that of --set, which a state of its own
/// completes.
std::string zshAction(const ValueKind& kind, bool settings) {
    if (settings) return "->settings";
    switch (kind.of) {
        case Of::Folders:
            return "_files -/";
        case Of::Files:
            if (kind.list.empty()) return "_files";
            return "_files -g \"*.(" + joined(kind.list, "|") + ")(-.)\"";
        case Of::Words:
            return "_lacuna_words " + joined(kind.list, " ");
        default:
            return " ";
    }
}

/// Text escaped for _arguments, where it stands between brackets and colons.
std::string zshText(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') safe += '\\';
        safe += c == '\n' ? ' ' : c;
    }
    return safe;
}

/// The specifications of an option for _arguments, one for each of its names.
std::vector<std::string> zshSpecifications(const CLI::Option& option, const ValueWords& words) {
    const ValueKind kind = valueKind(option, words);
    const std::string type = zshText(typeOf(option));
    if (option.get_positional()) {
        const bool many = option.get_items_expected_max() > 1;
        return {(many ? "*:" : ":") + type + ":" + zshAction(kind, false)};
    }
    const std::vector<std::string> names = namesOf(option);
    const bool repeats = option.get_items_expected_max() > 1;
    std::vector<std::string> all;
    for (const std::string& name : names) {
        const bool isLong = name.starts_with("--");
        std::string text = repeats ? "*" : "(" + joined(names, " ") + ")";
        text += name;
        if (kind.of != Of::Nothing) text += isLong ? "=" : "+";
        text += "[" + zshText(option.get_description()) + "]";
        if (kind.of != Of::Nothing) {
            text += ":" + type + ":" + zshAction(kind, name == "--set");
        }
        all.push_back(text);
    }
    return all;
}

}  // namespace

std::string bashCompletion(const CLI::App& app, const ValueWords& words) {
    std::vector<std::string> names;
    std::string values;
    for (const CLI::Option* option : app.get_options()) {
        if (!isShown(*option)) continue;
        const ValueKind kind = valueKind(*option, words);
        if (option->get_positional()) {
            // If there are two positional arguments, they are of one kind.
            if (!values.starts_with("        [ARGUMENT]")) {
                values = bashRow("ARGUMENT", bashKind(kind)) + values;
            }
            continue;
        }
        for (const std::string& name : namesOf(*option)) {
            names.push_back(name);
            if (kind.of != Of::Nothing) values += bashRow(name, bashKind(kind));
        }
    }
    std::string settings;
    for (const auto& [method, keys] : words.byMethod)
        settings += bashRow(method, joined(keys, " "));
    const std::string name = functionName(app);
    return "# Made by " + app.get_name() + " --help-as bash.\n" + kBashReader + name +
           "() {\n    local options=" + shellQuoted(joined(names, " ")) +
           "\n    local -A values=(\n" + values + "    )\n    local -A settings=(\n" + settings +
           "    )\n    _lacuna_complete\n}\ncomplete -F " + name + " " + app.get_name() + "\n";
}

std::string zshCompletion(const CLI::App& app, const ValueWords& words) {
    std::string specifications;
    for (const CLI::Option* option : app.get_options()) {
        if (!isShown(*option)) continue;
        for (const std::string& text : zshSpecifications(*option, words)) {
            specifications += " \\\n        " + shellQuoted(text);
        }
    }
    std::string settings;
    for (const auto& [method, keys] : words.byMethod) {
        settings += "        " + method + ") _lacuna_words " + joined(keys, " ") + " ;;\n";
    }
    if (!settings.empty()) {
        settings =
            "    [[ $state == settings ]] || return\n"
            "    case ${opt_args[--method]:-auto} in\n" +
            settings + "    esac\n";
    }
    const std::string name = functionName(app);
    return "#compdef " + app.get_name() + "\n# Made by " + app.get_name() + " --help-as zsh.\n" +
           kZshReader + name +
           "() {\n    local curcontext=$curcontext state line\n    typeset -A opt_args\n"
           "    _arguments" +
           specifications + "\n" + settings + "}\n" + name + " \"$@\"\n";
}

}  // namespace lacuna
