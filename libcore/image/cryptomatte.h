// Cryptomatte 1.2.0: what each pixel shows, by name, and how much of the pixel each of it covers, as
// layers that Blender, Nuke, Fusion and Natron cut mattes from.
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

/// A name's id as a float's bits: MurmurHash3_32 of its bytes, with an exponent that is neither that of
/// zero nor that of infinity.
std::uint32_t cryptomatteBits(std::string_view name);

/// The things of one type in a picture.
struct Matte {
    static constexpr std::size_t kRanks = 6;  ///< two in a layer
    struct Cover {
        std::uint32_t name = 0;  ///< among `names`
        float share = 0;         ///< of the pixel; 0: nothing
    };
    using Pixel = std::array<Cover, kRanks>;  ///< what covers most first

    std::string type;                ///< "CryptoObject"
    std::vector<std::string> names;  ///< that the manifest lists; UTF-8
    std::vector<Pixel> pixels;       ///< row by row
};

/// Of the image's Cryptomattes, for looking at: layers TYPE.R/G/B with each name in a colour of its own,
/// by its coverage.
LayeredImage cryptomattePictures(const LayeredImage& image);

/// Adds layers and attributes. Throws std::invalid_argument if the sizes differ.
void addCryptomatte(LayeredImage& image, const Matte& matte);

}  // namespace lacuna
