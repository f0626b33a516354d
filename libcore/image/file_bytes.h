// A file read whole and then taken apart in memory, where every step can be checked against its
// end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lacuna {

/// What a file may unpack to, by its content alone: so many bytes, and so many for each of its own. A flat
/// grid of a million triangles takes 2000 for each.
inline constexpr std::uint64_t kUnpackedFree = std::uint64_t(1) << 29, kUnpackedPerByte = 1 << 12;

/// All bytes of a regular file. Throws InputError if there is none, it cannot be read or is empty.
std::vector<std::uint8_t> readFileBytes(const std::string& path);

/// Throws InputError if a picture of that size, as a header claims it, is not to be allocated.
void requireSaneSize(const std::string& path, std::int64_t width, std::int64_t height);

/// The fewest bytes that a PNG of so many pixels can have: deflate makes 1032 of one at most. `file`: its
/// header at least. Decoders allocate what the header claims.
std::uint64_t fewestBytesOfPng(std::span<const std::uint8_t> file, std::uint64_t pixels);

/// Whether all chunks of a PNG up to its last one lie within the file. Decoders make room for what is claimed
/// here, too.
bool pngChunksFit(std::span<const std::uint8_t> file);

}  // namespace lacuna
