// Reads and writes pictures; the ending of the file's name selects the format.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/image/exr.h"
#include "libcore/image/image.h"
#include "libcore/image/image_file.h"
#include "libcore/image/tone.h"

namespace lacuna {

/// Opens .exr (R, G, B), .hdr (Radiance RGBE), .pfm (colour or grey) or .png (8 or 16 bit sRGB,
/// converted to linear; alpha is dropped). Throws UsageError for another ending, InputError if the
/// file cannot be read or claims more pixels than a file of its size may unpack to.
ImageFile openImage(const std::string& path);
/// The same, decoded.
Image readImage(const std::string& path);

/// Writes .exr (every channel and attribute), .pfm (R, G, B) or .png (R, G, B as sRGB, and A if the image has it; NaN
/// becomes black), atomically. Each style applies to its own format only. Throws UsageError for another ending,
/// RunError if the file cannot be written.
void writeImage(const std::string& path, const LayeredImage& image, const PngStyle& png = {},
                const ExrStyle& exr = {});

/// Throws what writeImage would throw: UsageError for the ending, RunError if the directory or the
/// file is not writable. It serves as a check before hours of rendering and leaves no file behind.
void requireWritable(const std::string& path);

/// The file name's ending in lower case with its dot, "" if it has none.
std::string endingOf(const std::string& path);

/// Readers and writers of single formats; errors as above.
ImageFile openHdr(const std::string& path);
ImageFile openPfm(const std::string& path);
ImageFile openPng(const std::string& path);
/// Whether writePng or writePngBytes wrote the file: they add a text chunk that says so. False for
/// anything else, also for a file that cannot be read.
bool isOurPng(const std::string& path);
void writePfm(const std::string& path, const Image& image);
/// `alpha`: coverage of the picture, whose colours are premultiplied by it; may be null.
void writePng(const std::string& path, const Image& image, const PngStyle& style,
              const std::vector<float>* alpha = nullptr);
/// Writes `values` unchanged: width * height * 3 sRGB numbers, or 4 with alpha, of 8 or 16 bits (high byte first).
/// Throws std::invalid_argument for another number of bytes.
void writePngBytes(const std::string& path, int width, int height,
                   const std::vector<std::uint8_t>& values, int bits = 8);

}  // namespace lacuna
