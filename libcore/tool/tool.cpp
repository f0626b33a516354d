#include "libcore/tool/tool.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <limits>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>

#include "libcore/base/error.h"
#include "libcore/tool/early_interrupt.h"

namespace lacuna {
namespace {

/// Prints an error as one line, whatever a library or a file name has put into the text.
int report(std::string message, int exitCode) {
    for (char& c : message) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    }
    std::fprintf(stderr, "%s\n", message.c_str());
    return exitCode;
}

/// All of `text` as a number of that type; empty if it is none, or too large for it.
template <class Integer>
std::optional<Integer> integerOf(const std::string& text) {
    const char* end = text.data() + text.size();
    Integer value = 0;
    const auto [at, error] = std::from_chars(text.data(), end, value);
    return error == std::errc{} && at == end ? std::optional(value) : std::nullopt;
}

/// Whether all of `text` is a 64-bit integer in ordinary decimal notation.
bool isDecimal(const std::string& text) {
    const std::size_t sign = text.starts_with('-') ? 1 : 0;
    if (text.size() > sign + 1 && text[sign] == '0') return false;
    return integerOf<std::uint64_t>(text) || integerOf<std::int64_t>(text);
}

/// Rejects values that CLI11 accepts silently: an empty text, 0640 (as octal), and integers that
/// are too large (as the largest one).
void checkValues(const CLI::Option& option) {
    const bool isInteger = option.get_type_name() == "N";
    for (const std::string& value : option.results()) {
        if (value.empty()) {
            throw UsageError(option.get_name() +
                             ": expected a value, found an empty text; leave the option out or "
                             "give it one");
        }
        if (isInteger && !isDecimal(value)) {
            throw UsageError(option.get_name() +
                             ": expected a decimal integer of at most 64 bits, found '" + value +
                             "'");
        }
    }
}

/// A check whose message names the bounds: that of CLI11 prints the largest double in full. It refuses signs, which
/// CLI11 lets wrap around in an unsigned number.
auto integerWithin(std::uint64_t low, std::uint64_t high) {
    return [=](const std::string& text) {
        const auto value = integerOf<std::uint64_t>(text);
        return value && low <= *value && *value <= high
                   ? std::string()
                   : "expected an integer from " + std::to_string(low) + " to " +
                         std::to_string(high) + ", found '" + text + "'";
    };
}

/// Whether the exception means that the system could not start a thread. That of oneTBB has no type
/// of its own.
bool isLackOfThreads(const std::exception& e) {
    const auto* system = dynamic_cast<const std::system_error*>(&e);
    return (system && system->code() == std::errc::resource_unavailable_try_again) ||
           std::string_view(e.what()).starts_with("pthread_create");
}

/// The terminate handler, for exceptions that nobody can catch: in threads of libraries, in
/// destructors.
[[noreturn]] void endWithOneLine() {
    static std::atomic_flag ending = ATOMIC_FLAG_INIT;
    while (ending.test_and_set()) pause();  // another thread is reporting
    // There is no current exception where a destructor threw while another one was on its way. The
    // destructors of JSON values allocate.
    const Failure failure =
        std::current_exception()
            ? failureOfCurrentException()
            : Failure{1,
                      "internal error, most likely for want of memory: use a smaller image or "
                      "scene, or raise its limit (ulimit -v); else please report it"};
    // Other threads are still running, so that nothing is destroyed. Files without a commit have no
    // name.
    _exit(report(failure.text, failure.exitCode));
}

/// Makes writing to a file that may not grow, or to a closed pipe, fail like other write errors.
void ignoreSignalsOfWriting() {
    for (const int number : {SIGXFSZ, SIGPIPE}) std::signal(number, SIG_IGN);
}

}  // namespace

void addCommonOptions(CLI::App& app, CommonOptions& options) {
    app.add_option("--cache", options.cacheDirectory, "Directory of caches (default: NAME.cache)")
        ->type_name("DIR");
    app.add_option("--threads", options.threads,
                   "Number of threads (default: all; at most 64, or 4 for each processor)")
        ->type_name("N")
        ->check(integerWithin(1, 4096));
    app.add_option("--seed", options.seed, "Seed of all random numbers (default: 1)")
        ->type_name("N")
        ->check(integerWithin(0, std::numeric_limits<std::uint64_t>::max()));
    app.add_option("--json", options.json, "Write everything measured to this file")
        ->type_name("FILE");
    app.add_flag("--quiet", options.quiet, "Print no progress and no remarks on stderr");
    app.add_flag("-v,--verbose", options.verbose, "Print more on stderr");
}

ThreadPool threadsOf(const CommonOptions& options) {
    return ThreadPool(options.threads, "--threads");
}

void makeCacheDirectory(const std::string& file) {
    const std::filesystem::path directory = std::filesystem::path(file).parent_path();
    if (directory.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) {
        throw RunError(directory.string() +
                       ": expected to make this directory for caches, found: " + error.message() +
                       "; name another directory for caches (--cache DIR)");
    }
}

std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv,
                                    const ValueWords& words) {
    addHelpForms(app, words);
    app.set_version_flag("--version", app.get_name() + " " + LACUNA_VERSION);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& done) {  // --help, --help-as, --version
        return app.exit(done);
    } catch (const CLI::ParseError& e) {
        throw UsageError("command line: " + std::string(e.what()) + "; see " + app.get_name() +
                         " --help");
    }
    for (const CLI::Option* option : app.get_options()) checkValues(*option);
    return std::nullopt;
}

std::string shellQuoted(const std::string& text) {
    constexpr std::string_view kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./,:=+@%";
    if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string commandLineText(int argc, const char* const* argv) {
    std::string text;
    for (int i = 0; i < argc; ++i) text += (i > 0 ? " " : "") + shellQuoted(argv[i]);
    return text;
}

Failure failureOfCurrentException() {
    try {
        throw;
    } catch (const Error& e) {
        return {e.exitCode(), e.what()};
    } catch (const std::bad_alloc&) {
        return {1, "memory: expected more, found none left; use a smaller image or scene"};
    } catch (const std::exception& e) {
        if (isLackOfThreads(e)) {
            return {1,
                    "threads: expected to start another, found no room for it; use fewer "
                    "(--threads), or raise the limits of processes or memory (ulimit)"};
        }
        return {1, "internal error: " + std::string(e.what()) + "; please report it"};
    } catch (...) {
        return {1, "internal error of unknown kind; please report it"};
    }
}

int runTool(const std::function<int()>& body) {
    std::set_terminate(endWithOneLine);
    endAtInterrupts();
    ignoreSignalsOfWriting();
    try {
        const int exitCode = body();
        std::cout.flush();
        if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout) {
            return report("stdout: expected to write results, found it closed or full", 1);
        }
        return exitCode;
    } catch (...) {
        const Failure failure = failureOfCurrentException();
        return report(failure.text, failure.exitCode);
    }
}

}  // namespace lacuna
