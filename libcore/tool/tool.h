// What every command-line tool of ours shares: options, exit codes, one line per error.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "libcore/tool/help_forms.h"

namespace lacuna {

/// Options that every tool takes so that scripts can pass them to all.
struct CommonOptions {
    std::string cacheDirectory;  // empty: beside the scene
    int threads = 0;             // 0: all
    std::uint64_t seed = 1;
    std::string json;  // empty: none
    bool quiet = false;
    bool verbose = false;
};

/// --cache --threads --seed --json --quiet -v. `app` and `options` must outlive the parsing.
void addCommonOptions(CLI::App& app, CommonOptions& options);

/// Parses, after adding --version and --help-as; `words` complete values in shells. nullopt: go on.
/// A value: help or version was printed, exit with it. Throws UsageError for a wrong command line.
std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv,
                                    const ValueWords& words = {});

/// A text as a shell takes it, in quotes where it needs them.
std::string shellQuoted(const std::string& text);
/// The arguments joined, as a shell would take them again.
std::string commandLineText(int argc, const char* const* argv);

/// How a tool ends that an exception ends.
struct Failure {
    int exitCode = 1;
    std::string text;  ///< one line for stderr
};
/// To be called where one was caught.
Failure failureOfCurrentException();

/// Runs a tool's body and returns its exit code. An exception becomes one line on stderr and the
/// code of its kind: Error its own, everything else 1. Results that could not reach stdout are a
/// failure (1) as well. What libraries throw in threads of theirs ends the same way. A file that
/// may not grow (ulimit -f) or a pipe that nobody reads is an error of writing and no signal.
int runTool(const std::function<int()>& body);

}  // namespace lacuna
