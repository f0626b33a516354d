// Seeds of the fuzzer: valid files of every kind.
#pragma once

#include <filesystem>

namespace lacuna::test {

/// Writes files that each parser (parsers.h) accepts to a subfolder of `folder` for that parser.
void writeSeeds(const std::filesystem::path& folder);

}  // namespace lacuna::test
