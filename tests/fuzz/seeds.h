// What the fuzzer starts from: sound files of every kind.
#pragma once

#include <filesystem>

namespace lacuna::test {

/// Files into a folder of `folder` for each parser (parsers.h), which accepts all of them.
void writeSeeds(const std::filesystem::path& folder);

}  // namespace lacuna::test
