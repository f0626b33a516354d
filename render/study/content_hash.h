// Names for what was run: the same content has the same name, whatever the file is called.
#pragma once

#include <string>
#include <string_view>

namespace lacuna {

/// Hex XXH3-128.
std::string contentHash(std::string_view bytes);
/// Of a file's bytes. Throws InputError if it cannot be read.
std::string fileHash(const std::string& path);

}  // namespace lacuna
