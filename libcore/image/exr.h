// OpenEXR files that the renderer writes and the tools read. (files.md, "EXR")
#pragma once

#include <cstdint>
#include <string>

#include "libcore/image/image.h"
#include "libcore/image/image_file.h"

namespace lacuna {

enum class ExrCompression : std::uint8_t {
    Zip,   ///< its checksum detects nearly all damage
    None,  ///< takes a tenth of the time
};

struct ExrStyle {
    ExrCompression compression = ExrCompression::Zip;
    /// 16-bit floats where they suffice: not for Z, position, variances, ids and a part's sums. Values beyond 65504 are
    /// clamped to it.
    bool half = false;
    /// Each layer is a part of its own, with the picture first, so that a reader of one layer need not decompress all.
    bool multiPart = false;
};

/// Writes every channel under its own name (float, or half as `style` says), and the attributes as
/// string, double and int, with the chromaticities of Rec. 709. The file has scan lines and is
/// written atomically (AtomicFile). Throws RunError if it cannot be written, std::invalid_argument
/// for an image without channels or an attribute name that belongs to OpenEXR.
void writeExr(const std::string& path, const LayeredImage& image, const ExrStyle& style = {});

/// The channels R, G, B of the first part that has them, over its data window; half or float, scan lines or tiles.
/// Throws InputError if the file cannot be read, is damaged or too large, or has no such channels.
ImageFile openExr(const std::string& path);
/// The same, decoded.
Image readExr(const std::string& path);

/// All channels (half or float) of all parts, which must have one size, and the attributes of type
/// string, double and int of the first part. If an earlier part has a channel of the same name, a
/// channel is called PART.CHANNEL. Throws InputError like readExr, and also for a channel of
/// integers.
LayeredImage readExrLayers(const std::string& path);

}  // namespace lacuna
