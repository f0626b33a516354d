// Protection of files whose library does not survive corrupt input: OpenVDB aborts, hangs or
// returns other numbers (files.md, "Sidecar"). A sidecar, FILE.xxh3, holds the file's length and
// XXH3-128. Both are compared before the library sees a byte. The file itself stays in the format
// that viewers expect.
#pragma once

#include <string>
#include <string_view>

namespace lacuna {

/// Writes the file and its sidecar, each atomically. If it is interrupted between the two, they do
/// not fit together and are refused. Throws RunError.
void writeGuarded(const std::string& path, std::string_view bytes);

/// The whole file. Throws InputError if it or its sidecar is missing, or if they do not fit
/// together; `remedy` tells the user what to do then.
std::string readGuarded(const std::string& path, const std::string& remedy);

}  // namespace lacuna
