// Whether what a tool writes would replace what it reads, or something else that it writes.
#pragma once

#include <span>
#include <string>

namespace lacuna {

/// A file with the name that messages have for it: "--json", "the scene".
struct NamedFile {
    std::string name;
    std::string path;  ///< empty: not asked for
};

/// Throws UsageError where a result and an input, or two results, are one file, by whatever paths
/// and links. Devices (/dev/null, /dev/stdout) may well be named twice.
void requireOwnFiles(std::span<const NamedFile> results, std::span<const NamedFile> inputs);

}  // namespace lacuna
