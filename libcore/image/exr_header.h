// What an EXR header claims, checked before OpenEXR allocates by it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lacuna {

/// Walks the attributes of all parts' headers: each has to lie inside the file, data windows have
/// to be of a sane size, tables of tiles and scan lines have to fit into the file. OpenEXR checks the
/// rest itself. Throws InputError, also for deep files, which no tool of ours writes.
void checkExrHeader(const std::string& path, const std::vector<std::uint8_t>& bytes);

}  // namespace lacuna
