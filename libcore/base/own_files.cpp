#include "libcore/base/own_files.h"

#include <filesystem>
#include <system_error>

#include "libcore/base/error.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

/// Whether two paths name one file, which need not exist yet: "a.png" and "./a.png".
bool isSame(const std::string& a, const std::string& b) {
    if (a.empty() || b.empty()) return false;
    std::error_code error;
    if (fs::is_character_file(a, error)) return false;
    if (fs::equivalent(a, b, error)) return true;
    // weakly_canonical leaves a relative path relative if no part of it exists.
    const fs::path one = fs::weakly_canonical(fs::absolute(a, error), error),
                   other = fs::weakly_canonical(fs::absolute(b, error), error);
    return one == other;
}

void requireDifferent(const NamedFile& result, const NamedFile& other) {
    if (!isSame(result.path, other.path)) return;
    throw UsageError(result.name + ": expected a file of its own, found " + other.name + ", " +
                     other.path + "; choose another name");
}

}  // namespace

void requireOwnFiles(std::span<const NamedFile> results, std::span<const NamedFile> inputs) {
    for (std::size_t i = 0; i < results.size(); ++i) {
        for (const NamedFile& input : inputs) requireDifferent(results[i], input);
        for (std::size_t j = 0; j < i; ++j) requireDifferent(results[i], results[j]);
    }
}

}  // namespace lacuna
