// OpenEXR files: what the renderer writes and what the tools read back. (files.md, "EXR")
#pragma once

#include <cstdint>
#include <string>

#include "libcore/image/image.h"

namespace lacuna {

enum class ExrCompression : std::uint8_t {
    Zip,   ///< whose checksum finds nearly all damage
    None,  ///< in a tenth of the time
};

/// Writes every channel under its own name as 32-bit float, and the attributes as string, double
/// and int: one part, scanlines. Atomic (AtomicFile).
/// Throws RunError if it cannot be written, std::invalid_argument for an image without channels or
/// an attribute name that belongs to OpenEXR.
void writeExr(const std::string& path, const LayeredImage& image,
              ExrCompression compression = ExrCompression::Zip);

/// The channels R, G, B of the data window; half or float, scanlines or tiles.
/// Throws InputError if the file cannot be read, is damaged, too large or has no such channels.
Image readExr(const std::string& path);

/// All channels (half or float) and the attributes of type string, double and int.
/// Throws InputError like readExr; a channel of integers is an error too.
LayeredImage readExrLayers(const std::string& path);

}  // namespace lacuna
