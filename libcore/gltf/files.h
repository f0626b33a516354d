// Bytes from files and data URIs, and the rules for files to which a scene file may refer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "libcore/base/content_hash.h"

namespace lacuna::gltf {

/// Owned bytes, uninitialised until they are read into (a scene can be gigabytes).
struct Bytes {
    std::unique_ptr<std::uint8_t[]> data;
    std::size_t size = 0;
    std::span<const std::uint8_t> span() const { return {data.get(), size}; }
};

/// All bytes of the regular file `path`. `askedBy` is named in the message when the file is not the
/// scene itself. Throws InputError if there is none, it is no regular file, it has more than
/// `mostBytes` or it cannot be read.
Bytes readFile(const std::filesystem::path& path, std::uint64_t mostBytes,
               const std::string& askedBy = "");

/// Adds the bytes of `path` to `hash` without keeping them. Throws like readFile.
void hashFile(const std::filesystem::path& path, ContentHash& hash, const std::string& askedBy);

bool isDataUri(std::string_view uri);

/// Payload of `data:[type][;parameters];base64,...`. Throws InputError (naming `file` and `place`)
/// if it is not that.
Bytes decodeDataUri(const std::string& file, const std::string& place, std::string_view uri);

/// The path below the scene's folder that a relative, percent-encoded URI names. Throws InputError
/// for absolute URIs, for those with a scheme and for those that leave the folder by `..`.
std::filesystem::path resolveUri(const std::string& file, const std::string& place,
                                 std::string_view uri);

/// The same for a plain file name, in which `%` is an ordinary character.
std::filesystem::path resolveFileName(const std::string& file, const std::string& place,
                                      std::string_view name);

}  // namespace lacuna::gltf
