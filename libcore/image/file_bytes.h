// Whole files in memory, where every step of parsing can be checked against the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lacuna {

/// The largest size to which a file may unpack: a constant number of bytes, and a number for each byte of the file. (A
/// flat grid of a million triangles needs 2000 per byte.)
inline constexpr std::uint64_t kUnpackedFree = std::uint64_t(1) << 29, kUnpackedPerByte = 1 << 12;

/// All bytes of a regular file. Throws InputError if it does not exist, cannot be read or is empty.
std::vector<std::uint8_t> readFileBytes(const std::string& path);

/// Throws InputError if a picture of the size that a header claims is too large to allocate.
void requireSaneSize(const std::string& path, std::int64_t width, std::int64_t height);

/// Throws InputError if `pixelBytes`, the size of a picture in memory, is more than a file of `fileBytes` bytes may
/// unpack to.
void requireModestSize(const std::string& path, std::uint64_t pixelBytes, std::uint64_t fileBytes);

/// The fewest bytes that a PNG of this number of pixels can have: deflate expands a byte to 1032 at most. `file`: at
/// least its header. Needed because decoders allocate what the header claims.
std::uint64_t fewestBytesOfPng(std::span<const std::uint8_t> file, std::uint64_t pixels);

/// Whether all chunks of a PNG up to its last one lie within the file. Needed because decoders allocate the claimed
/// sizes of chunks, too.
bool pngChunksFit(std::span<const std::uint8_t> file);

}  // namespace lacuna
