// Shared parts of all command-line tools: options, exit codes, one line per error.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "libcore/base/parallel.h"
#include "libcore/tool/help_forms.h"

namespace lacuna {

/// Options that every tool takes so that scripts can pass them to all.
struct CommonOptions {
    std::string cacheDirectory;  // empty: beside the scene
    int threads = 0;             // 0: all
    std::uint64_t seed = 1;
    std::string json;  // empty: not written
    bool quiet = false;
    bool verbose = false;
};

/// --cache --threads --seed --json --quiet -v. `app` and `options` must outlive the parsing.
void addCommonOptions(CLI::App& app, CommonOptions& options);

/// The threads that --threads asks for. Throws as ThreadPool does, with the option's name.
ThreadPool threadsOf(const CommonOptions& options);

/// Creates the directory of `file`, a cache. Throws RunError, which asks for another directory.
void makeCacheDirectory(const std::string& file);

/// Adds --version and --help-as and parses the command line. `words` complete values in shells.
/// Returns an exit code if help or version was printed; else nullopt. Throws UsageError for a wrong
/// command line.
std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv,
                                    const ValueWords& words = {});

/// A text quoted for a shell where needed.
std::string shellQuoted(const std::string& text);
/// The command line as text that can be given to a shell again.
std::string commandLineText(int argc, const char* const* argv);

/// The exit code and message for an exception that ends a tool.
struct Failure {
    int exitCode = 1;
    std::string text;  ///< one line for stderr
};
/// To be called while an exception is being handled.
Failure failureOfCurrentException();

/// Runs a tool's body and returns its exit code. An exception becomes one line on stderr and an
/// exit code: that of an Error, 1 for all others. Results that could not be written to stdout are a
/// failure (1) as well. Exceptions in threads of libraries end the same way. Writing to a file that
/// may not grow (ulimit -f) or to a pipe without a reader is an error and not a signal.
int runTool(const std::function<int()>& body);

}  // namespace lacuna
