// The content of --help as a manual page and as completion for shells. All are generated from the
// same options and texts, so that they cannot disagree.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lacuna {

/// Words that complete the values of options. `key=` stands for any value of the key.
struct ValueWords {
    std::map<std::string, std::vector<std::string>> byOption;  ///< "--sampler": its names
    std::map<std::string, std::vector<std::string>> byMethod;  ///< for --set, by --method
};

/// Adds --help-as man|bash|zsh, which prints and ends the program like --help. `app` must outlive
/// the parsing.
void addHelpForms(CLI::App& app, ValueWords words);

/// A page for man(1). Its text is the app's footer. In the footer, `Examples:` begins lines of
/// commands; `Exit codes:` begins the last part, "0 done, 1 ...".
std::string manualPage(const CLI::App& app);
/// A script for bash, to be sourced or to be installed in its directory of completions.
std::string bashCompletion(const CLI::App& app, const ValueWords& words);
/// A script for zsh, to be installed in its `fpath` as _PROGRAM.
std::string zshCompletion(const CLI::App& app, const ValueWords& words);

/// How the value of an option or argument is completed.
struct ValueKind {
    enum class Of { Nothing, Anything, Words, Files, Folders };
    Of of = Of::Anything;
    std::vector<std::string> list = {};  ///< words, or the endings of files (none: all)
};
/// Derived from the name of the option's type: `FILE`, `SCENE.glb`, `DIR`, `standard|filmic`. Flags
/// have none.
ValueKind valueKind(const CLI::Option& option, const ValueWords& words);
/// The option's names with their dashes, letters first.
std::vector<std::string> namesOf(const CLI::Option& option);
/// The value's type as --help shows it, "FILE", or nothing. For an argument without a type, its
/// name.
std::string typeOf(const CLI::Option& option);

}  // namespace lacuna
