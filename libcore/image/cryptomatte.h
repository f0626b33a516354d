// Cryptomatte 1.2.0: the names of the things that each pixel shows, and the share of the pixel that
// each covers, as layers from which Blender, Nuke, Fusion and Natron cut mattes.
//
//     TYPE00.R G B A   id and coverage of rank 0, id and coverage of rank 1; TYPE01, TYPE02 likewise
//     cryptomatte/KEY/name, hash, conversion, manifest   attributes; KEY: 7 digits of the hash of TYPE
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libcore/image/image.h"

namespace lacuna {

/// The id of a name as the bits of a float: MurmurHash3_32 of its bytes, changed where needed so that the exponent is
/// neither that of zero nor that of infinity.
std::uint32_t cryptomatteBits(std::string_view name);

/// The Cryptomatte of one type: which things cover each pixel.
struct Matte {
    static constexpr std::size_t kRanks = 6;  ///< two per layer
    struct Cover {
        std::uint32_t name = 0;  ///< index into `names`
        float share = 0;         ///< covered share of the pixel; 0: unused rank
    };
    using Pixel = std::array<Cover, kRanks>;  ///< by decreasing share

    std::string type;                ///< "CryptoObject"
    std::vector<std::string> names;  ///< names in the manifest; UTF-8
    std::vector<Pixel> pixels;       ///< row-major
};

/// The image's Cryptomattes as visible pictures: layers TYPE.R/G/B in which each name has its own colour, weighted by
/// coverage.
LayeredImage cryptomattePictures(const LayeredImage& image);

/// Adds the matte's layers and attributes to the image. Throws std::invalid_argument if the sizes
/// differ.
void addCryptomatte(LayeredImage& image, const Matte& matte);

}  // namespace lacuna
