// Pictures from and to files, by the ending of the name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/image/exr.h"
#include "libcore/image/image.h"
#include "libcore/image/tone.h"

namespace lacuna {

/// .exr (R, G, B), .hdr (Radiance RGBE), .pfm (colour or grey), .png (8 or 16 bit sRGB, made
/// linear; alpha is dropped). Throws UsageError for another ending, InputError for what cannot be
/// read.
Image readImage(const std::string& path);

/// .exr: every channel and attribute; .pfm: R, G, B; .png: R, G, B as sRGB, and A where there is one; NaN as black. Each style is of
/// use for its own ending only. Atomic.
/// Throws UsageError for another ending, RunError if it cannot be written.
void writeImage(const std::string& path, const LayeredImage& image, const PngStyle& png = {},
                const ExrStyle& exr = {});

/// Throws what writeImage would: UsageError for the ending, RunError if the directory or the file
/// is not writable. For a check before hours of rendering; leaves no file behind.
void requireWritable(const std::string& path);

/// Lower-case ending of the file name with its dot, "" if it has none.
std::string endingOf(const std::string& path);

/// One format each; errors as above.
Image readHdr(const std::string& path);
Image readPfm(const std::string& path);
Image readPng(const std::string& path);
/// Whether it is a PNG that writePng or writePngBytes wrote: these say so in a chunk of text. False
/// for anything else, a file that cannot be read as well.
bool isOurPng(const std::string& path);
void writePfm(const std::string& path, const Image& image);
/// `alpha`: of the picture, whose colours are premultiplied by it; may be null.
void writePng(const std::string& path, const Image& image, const PngStyle& style,
              const std::vector<float>* alpha = nullptr);
/// `values`: width * height * 3 numbers, or 4 with alpha, of 8 or 16 bits (the high byte first), sRGB, as
/// they are to stand in the file. Throws std::invalid_argument for another number of bytes.
void writePngBytes(const std::string& path, int width, int height,
                   const std::vector<std::uint8_t>& values, int bits = 8);

}  // namespace lacuna
