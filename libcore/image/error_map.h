// A false-colour picture of the error of an image against its reference.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcore/image/error_metrics.h"

namespace lacuna {

/// The scale: logarithmic, black at and below kErrorMapLow, pale yellow at and above kErrorMapHigh.
inline constexpr double kErrorMapLow = 1e-3;
inline constexpr double kErrorMapHigh = 1e1;
/// The same in words, for help texts.
inline constexpr const char* kErrorMapScale =
    "mean over R, G, B of |I - R| / (R + e), e = 0.01 mean R; logarithmic: black 0.001 or less, "
    "violet 0.01, red 0.1, orange 1, pale yellow 10 or more";

/// sRGB bytes for a relative error >= 0 (infinity included); lightness grows with the error.
std::array<std::uint8_t, 3> errorColour(double relativeError);

/// The error map in sRGB bytes, width * height * 3, top row first. Throws InputError like
/// ErrorReference::compare.
std::vector<std::uint8_t> errorMap(const Image& image, const ErrorReference& reference,
                                   const std::string& name = "image");

}  // namespace lacuna
