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

struct ExrStyle {
    ExrCompression compression = ExrCompression::Zip;
    /// 16-bit float where that is enough: not for Z, position, variances, ids and a part's sums. What is
    /// beyond 65504 becomes that.
    bool half = false;
    /// Each layer is a part of its own, the picture the first, so that who reads one need not unpack all.
    bool multiPart = false;
};

/// Writes every channel under its own name as float, and the attributes as string, double
/// and int, with the chromaticities of Rec. 709: scanlines. Atomic (AtomicFile).
/// Throws RunError if it cannot be written, std::invalid_argument for an image without channels or
/// an attribute name that belongs to OpenEXR.
void writeExr(const std::string& path, const LayeredImage& image, const ExrStyle& style = {});

/// The channels R, G, B of the data window, of the first part that has them; half or float, scanlines
/// or tiles. Throws InputError if the file cannot be read, is damaged, too large or has no such channels.
Image readExr(const std::string& path);

/// All channels (half or float) of all parts, which must be of one size, and the attributes of type
/// string, double and int of the first. A channel of a name that an earlier part has is called
/// PART.CHANNEL. Throws InputError like readExr; a channel of integers is an error too.
LayeredImage readExrLayers(const std::string& path);

}  // namespace lacuna
