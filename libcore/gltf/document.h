// A glTF file taken apart and checked: its structure as tinygltf's structs, its payload as byte
// ranges.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "libcore/gltf/files.h"
#include "libcore/gltf/report.h"

namespace lacuna::gltf {

/// What loadDocument leaves to the rest of the reader: every index in `model` and `json` that
/// guard.h's rules name is in range, every buffer view lies within its buffer.
///
/// tinygltf gets the JSON without `buffers`, `images`, `animations` and `skins`: all its known
/// faults (unchecked views handed to the image decoder, `..` URIs that are read, two copies of the
/// payload) are in code that then has nothing to do. What belongs to those keys is kept in `json`,
/// together with `materials` and `scenes`, whose extensions and extras are read from there.
struct Document {
    std::string file;
    Bytes bytes;
    std::vector<Bytes> external;
    std::vector<std::span<const std::uint8_t>> buffers;  ///< byteLength bytes each
    nlohmann::json json;
    std::map<std::size_t, nlohmann::json> nodeExtras;  ///< by node, of those that have some
    tinygltf::Model model;
    ContentHash hash;  ///< of everything that was read, in order
    std::uint64_t bytesRead = 0;
    std::size_t scene = 0;  ///< the default scene; model.scenes may be empty

    /// Bytes of a buffer view, which must be a valid index.
    std::span<const std::uint8_t> view(int bufferView) const;
    /// Reads a whole external file, counting and hashing its bytes.
    Bytes readExternal(const std::filesystem::path& path, const std::string& place);
};

/// Parses `bytes`, the content of `file`, into `document`, and reads its external buffers (not its
/// images). Throws InputError.
void loadDocument(const std::string& file, Bytes bytes, Document& document, Warnings& warnings);

}  // namespace lacuna::gltf
