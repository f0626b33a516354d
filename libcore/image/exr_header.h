// What an EXR header claims, checked before OpenEXR allocates by it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lacuna {

/// Walks the attributes of the first header: each has to lie inside the file, the data window has
/// to be of a sane size, the table of tiles has to fit into the file. OpenEXR checks the rest
/// itself. Throws InputError, also for deep and multi-part files, which no tool of ours writes.
void checkExrHeader(const std::string& path, const std::vector<std::uint8_t>& bytes);

}  // namespace lacuna
