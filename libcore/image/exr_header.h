// Check of the claims in an EXR header before OpenEXR allocates by them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lacuna {

/// Walks through the attributes of all parts' headers. Each attribute must lie inside the file, data windows must have
/// a sane size, and tables of tiles and scan lines must fit into the file. OpenEXR checks the rest itself. Throws
/// InputError, also for deep files, which are not supported.
void checkExrHeader(const std::string& path, const std::vector<std::uint8_t>& bytes);

}  // namespace lacuna
