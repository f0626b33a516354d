// Pictures from and to files, by the ending of the name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/image/image.h"

namespace lacuna {

/// .exr (R, G, B), .hdr (Radiance RGBE), .pfm (colour or grey), .png (8 or 16 bit sRGB, made
/// linear; alpha is dropped). Throws UsageError for another ending, InputError for what cannot be
/// read.
Image readImage(const std::string& path);

/// .exr: every channel and attribute; .pfm: R, G, B; .png: R, G, B times 2^exposure as 8-bit sRGB,
/// clamped, NaN as black. `exposure` in stops, used for .png only. Atomic.
/// Throws UsageError for another ending, RunError if it cannot be written.
void writeImage(const std::string& path, const LayeredImage& image, double exposure = 0.0);

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
void writePng(const std::string& path, const Image& image, double exposure);
/// `rgb`: width * height * 3 bytes, sRGB, as they are to stand in the file.
void writePngBytes(const std::string& path, int width, int height,
                   const std::vector<std::uint8_t>& rgb);

}  // namespace lacuna
