// The checks before any library sees the file: container, nesting, and the type of every value and
// the range of every index that the reader uses.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "libcore/gltf/report.h"

namespace lacuna::gltf {

/// The two parts of a file. `binary` is empty for .gltf and for .glb without a BIN chunk.
struct Chunks {
    std::string_view json;
    std::span<const std::uint8_t> binary;
};

/// Splits a .glb into its chunks; its first bytes tell that it is one, not its name. Anything else
/// that starts like a JSON object is taken as a .gltf. Throws InputError for all other files, and
/// for chunks that do not fit the file.
Chunks splitContainer(const std::string& file, std::span<const std::uint8_t> bytes);

/// Throws InputError if brackets nest deeper than Limits::kJsonDepth: the parsers recurse.
void checkJsonDepth(const std::string& file, std::string_view text);

/// Throws InputError if a value that the reader uses has the wrong JSON type, or an index points
/// past the end of its array. tinygltf would ignore the former (taking the default) and truncate
/// large numbers of the latter to 32 bits.
void checkRules(const std::string& file, const nlohmann::json& root);

/// Throws InputError for a version other than 2.x and for required extensions that are not
/// supported. Warns of other unsupported names in extensionsUsed: for known extensions what is
/// lost, for unknown ones the name.
void checkVersionAndExtensions(const std::string& file, const nlohmann::json& root,
                               Warnings& warnings);

}  // namespace lacuna::gltf
