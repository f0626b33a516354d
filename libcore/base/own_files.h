// Check that a tool's results replace neither its inputs nor each other.
#pragma once

#include <span>
#include <string>

namespace lacuna {

/// A file and its name in messages: "--json", "the scene".
struct NamedFile {
    std::string name;
    std::string path;  ///< empty: not requested
};

/// Throws UsageError where a result and an input, or two results, are one file, by whatever paths
/// and links. Devices (/dev/null, /dev/stdout) may be named twice.
void requireOwnFiles(std::span<const NamedFile> results, std::span<const NamedFile> inputs);

}  // namespace lacuna
