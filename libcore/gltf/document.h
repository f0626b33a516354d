// A parsed and checked glTF file: its structure as tinygltf's structs, its payload as byte ranges.
#pragma once

#include <tiny_gltf.h>

#include <atomic>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "libcore/gltf/files.h"
#include "libcore/gltf/limits.h"
#include "libcore/gltf/node_list.h"
#include "libcore/gltf/report.h"
#include "libcore/image/file_bytes.h"

namespace lacuna::gltf {

/// The number of bytes that decoders may still allocate: a stream of a few bytes can claim any
/// number of vertices. Bytes that were taken are never given back.
class Allowance {
  public:
    /// Adds the allowance of a file of `bytes` bytes (file_bytes.h).
    void addFile(std::uint64_t bytes);
    /// Takes `bytes` if as many are left; otherwise returns false. Thread-safe.
    bool take(std::uint64_t bytes);

  private:
    std::atomic<std::uint64_t> left_ = kUnpackedFree;
};

/// The result of loadDocument. Every index in `model` and `json` that the rules of guard.h name is
/// in range, and every buffer view lies within its buffer.
///
/// tinygltf gets the JSON without `buffers`, `images`, `animations`, `skins` and `nodes`. All its known faults
/// (unchecked views handed to the image decoder, `..` URIs that are read, two copies of the payload) are in code that
/// then has nothing to do. `json` keeps the content of these keys except `nodes`, together with `materials`, `textures`
/// and `scenes`, whose extensions and extras are read from it.
///
/// Compressed meshes are unpacked before tinygltf sees them. The decoded buffers, views and accessors follow the file's
/// own, and nothing refers to a compressed one.
struct Document {
    std::string file;
    Bytes bytes;
    std::vector<Bytes> external;
    std::vector<std::span<const std::uint8_t>> buffers;  ///< byteLength bytes each
    nlohmann::json json;
    std::vector<Node> nodes;
    tinygltf::Model model;  ///< without nodes
    ContentHash hash;       ///< of everything that was read, in order
    std::uint64_t bytesRead = 0;
    Allowance allowance;
    std::size_t scene = 0;  ///< the default scene; model.scenes may be empty

    /// Bytes of a buffer view, which must be a valid index.
    std::span<const std::uint8_t> view(int bufferView) const;
    /// Reads a whole external file, counting and hashing its bytes.
    Bytes readExternal(const std::filesystem::path& path, const std::string& place);
};

/// Throws InputError for the range at `place`, which does not lie within the `size` bytes of its buffer.
[[noreturn]] void refuseRange(const std::string& file, const std::string& place,
                              std::uint64_t length, std::uint64_t offset, std::size_t size);

/// The bytes of `range` (a buffer view, or an object with the same members) in the buffers loaded so far. Throws
/// InputError, naming `place`, if it has no buffer or length or leaves the buffer.
std::span<const std::uint8_t> rangeOf(const Document& document, const nlohmann::json& range,
                                      const std::string& place);

/// Adds a buffer of decoded bytes and returns its index.
std::size_t addBuffer(Document& document, Bytes bytes);

/// Throws InputError: the file needs more memory than Document::allowance has left.
[[noreturn]] void refuseUnpacking(const Document& document, const std::string& place,
                                  const char* advice = "export again without compression");

/// Parses `bytes`, the content of `file`, into `document`, and reads its external buffers (not its
/// images). Throws InputError.
void loadDocument(const std::string& file, Bytes bytes, Document& document, Warnings& warnings);

}  // namespace lacuna::gltf
