// From linear radiance to what a screen shows.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcore/image/image.h"

namespace lacuna {

/// How values beyond what a screen shows are brought into its range.
enum class Tone {
    Standard,  ///< none: what is above 1 is white
    Filmic     ///< mid-grey stays, contrast rises a little, highlights fade to white at 16
};

/// "standard", "filmic".
const char* nameOf(Tone tone);
/// Throws UsageError that names `option`.
Tone parseTone(const std::string& option, const std::string& text);

/// How a picture becomes a .png.
struct PngStyle {
    std::optional<double> exposure = 0.0;  ///< stops; none: automaticExposure
    Tone tone = Tone::Standard;
    int bits = 8;  ///< per channel: 8 or 16

    double stopsFor(const Image& image) const;
};

/// "auto" is none; else stops from -1000 to 1000. Throws UsageError that names `option`.
std::optional<double> parseExposure(const std::string& option, const std::string& text);

/// Stops that bring what there is to see to mid-grey (0.18): the mean of log luminance, without the
/// darkest and the brightest tenth. A lamp, a window or a firefly is among the latter, so that a
/// noisy picture gets what a clean one gets; what is black has no say. 0 for a black picture.
double automaticExposure(const Image& image);

/// What a screen is to show of a radiance times `scale` (2^stops): shares of its full output, linear,
/// 0 to 1. Below 0 and NaN are 0.
std::array<double, 3> toned(const Rgb& radiance, double scale, Tone tone);

/// IEC 61966-2-1, both ways, on [0, 1].
double srgbToLinear(double v);
double linearToSrgb(double v);

/// The picture as a .png holds it, top row first, three channels of one byte or (16 bits) of two,
/// the high one first. With `alpha` (may be null) there are four, and colours are divided by it, which
/// the picture's are not: none where it is 0.
std::vector<std::uint8_t> developed(const Image& image, const PngStyle& style,
                                    const std::vector<float>* alpha = nullptr);

}  // namespace lacuna
