// What --help says, in the forms that manuals and shells read: made of the same options and texts,
// so that none of them can say something else.
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
    std::map<std::string, std::vector<std::string>> byMethod;  ///< of --set, by what --method says
};

/// --help-as man|bash|zsh, which prints and ends as --help does. `app` must outlive the parsing.
void addHelpForms(CLI::App& app, ValueWords words);

/// A page for man(1). The app's footer is its text; in it `Examples:` begins lines of commands, and
/// `Exit codes:` begins "0 done, 1 ..." and ends it.
std::string manualPage(const CLI::App& app);
/// To be sourced by bash, or to lie where it looks for the completion of the program.
std::string bashCompletion(const CLI::App& app, const ValueWords& words);
/// To lie in zsh's `fpath` as _PROGRAM.
std::string zshCompletion(const CLI::App& app, const ValueWords& words);

/// How the value of an option or argument is completed.
struct ValueKind {
    enum class Of { Nothing, Anything, Words, Files, Folders };
    Of of = Of::Anything;
    std::vector<std::string> list = {};  ///< words, or the endings of files (none: all)
};
/// By the name of its type: `FILE`, `SCENE.glb`, `DIR`, `standard|filmic`. Flags have none.
ValueKind valueKind(const CLI::Option& option, const ValueWords& words);
/// Its names with their dashes, letters first.
std::vector<std::string> namesOf(const CLI::Option& option);
/// As --help shows the value, "FILE", or nothing; of an argument without a type its name.
std::string typeOf(const CLI::Option& option);

}  // namespace lacuna
