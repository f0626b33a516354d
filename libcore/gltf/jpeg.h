// JPEG textures: what is looked at before stb_image decodes them, and its decoder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

namespace lacuna::gltf {

/// What the decoder takes on trust.
struct JpegSegments {
    std::size_t scans = 0;  ///< each goes over all blocks; an empty one takes ten bytes
    bool tablesFit = true;  ///< no Huffman table has more than the 256 codes that there is room for
};

/// Reads the segments of a JPEG up to its end as the decoder does. `coded`: from the first marker on.
JpegSegments segmentsOfJpeg(std::span<const std::uint8_t> coded);

/// Texels of 8 bits per channel, rows from the top. `texels` is null where the picture is damaged; then
/// `damage` is a reason, which may be null too.
struct DecodedImage {
    struct Free {
        void operator()(std::uint8_t* texels) const { std::free(texels); }
    };
    int width = 0, height = 0;
    int channels = 4;  ///< grey; grey and alpha; RGB; RGBA
    std::unique_ptr<std::uint8_t, Free> texels;
    const char* damage = nullptr;
};

/// Width and height as the header says; false for one that is damaged. At most 2^31 - 1 bytes.
bool readJpegSize(std::span<const std::uint8_t> coded, int& width, int& height);

/// Decodes what `segmentsOfJpeg` has found to be in order. What a damaged file does not give is zero.
DecodedImage decodeJpeg(std::span<const std::uint8_t> coded);

}  // namespace lacuna::gltf
