// A glTF file taken apart and checked: its structure as tinygltf's structs, its payload as byte
// ranges.
#pragma once

#include <tiny_gltf.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "libcore/gltf/files.h"
#include "libcore/gltf/limits.h"
#include "libcore/gltf/report.h"
#include "libcore/image/file_bytes.h"

namespace lacuna::gltf {

/// How many bytes decoders may still allocate: a stream of a few bytes can claim any number of
/// vertices. What was taken is not given back.
class Allowance {
  public:
    /// Adds what a file of `bytes` bytes may ask for (file_bytes.h).
    void addFile(std::uint64_t bytes);
    /// Whether `bytes` are left, which are then taken. From any thread.
    bool take(std::uint64_t bytes);

  private:
    std::atomic<std::uint64_t> left_ = kUnpackedFree;
};

/// What loadDocument leaves to the rest of the reader: every index in `model` and `json` that
/// guard.h's rules name is in range, every buffer view lies within its buffer.
///
/// tinygltf gets the JSON without `buffers`, `images`, `animations` and `skins`: all its known
/// faults (unchecked views handed to the image decoder, `..` URIs that are read, two copies of the
/// payload) are in code that then has nothing to do. What belongs to those keys is kept in `json`,
/// together with `materials`, `textures` and `scenes`, whose extensions and extras are read from there.
///
/// Compressed meshes are unpacked before tinygltf sees them: behind the file's own buffers, views and
/// accessors come those that were decoded, and nothing refers to a compressed one.
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
    Allowance allowance;
    std::size_t scene = 0;  ///< the default scene; model.scenes may be empty

    /// Bytes of a buffer view, which must be a valid index.
    std::span<const std::uint8_t> view(int bufferView) const;
    /// Reads a whole external file, counting and hashing its bytes.
    Bytes readExternal(const std::filesystem::path& path, const std::string& place);
};

/// Throws InputError that names `place`: a range of the file that does not lie within the `size` bytes of its
/// buffer.
[[noreturn]] void refuseRange(const std::string& file, const std::string& place,
                              std::uint64_t length, std::uint64_t offset, std::size_t size);

/// The bytes that `range` (a buffer view, or what has the same members) names in the buffers loaded so
/// far. Throws InputError, naming `place`, if it has no buffer or length or leaves the buffer.
std::span<const std::uint8_t> rangeOf(const Document& document, const nlohmann::json& range,
                                      const std::string& place);

/// Adds a buffer of decoded bytes; its index.
std::size_t addBuffer(Document& document, Bytes bytes);

/// Throws InputError: more was asked for than Document::allowance has.
[[noreturn]] void refuseUnpacking(const Document& document, const std::string& place,
                                  const char* advice = "export again without compression");

/// Parses `bytes`, the content of `file`, into `document`, and reads its external buffers (not its
/// images). Throws InputError.
void loadDocument(const std::string& file, Bytes bytes, Document& document, Warnings& warnings);

}  // namespace lacuna::gltf
