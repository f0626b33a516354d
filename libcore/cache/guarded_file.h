// Files that a library reads which does not survive corrupt ones: OpenVDB aborts, hangs or returns
// other numbers (files.md, "Sidecar"). Length and XXH3-128 of a file lie in a sidecar, FILE.xxh3,
// and are compared before the library sees a byte. The file itself stays what viewers expect.
#pragma once

#include <string>
#include <string_view>

namespace lacuna {

/// Both files, each atomically. Interrupted between the two, the pair does not fit and is refused.
/// Throws RunError.
void writeGuarded(const std::string& path, std::string_view bytes);

/// All of the file. Throws InputError if it or its sidecar is missing, or they do not fit together;
/// `remedy` says what to do then.
std::string readGuarded(const std::string& path, const std::string& remedy);

}  // namespace lacuna
