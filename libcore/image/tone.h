// Tone mapping: from linear radiance to the values that a screen shows.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcore/image/image.h"

namespace lacuna {

/// The curve that maps values to the range of a screen.
enum class Tone {
    Standard,  ///< no curve: values above 1 are clamped
    Filmic     ///< keeps mid-grey, raises contrast a little; highlights fade to white at 16
};

/// "standard" or "filmic".
const char* nameOf(Tone tone);
/// The tone of that name. Throws UsageError, which names `option`.
Tone parseTone(const std::string& option, const std::string& text);

/// Settings of the conversion of a picture to a .png.
struct PngStyle {
    std::optional<double> exposure = 0.0;  ///< in stops; empty: automaticExposure
    Tone tone = Tone::Standard;
    int bits = 8;  ///< per channel: 8 or 16

    double stopsFor(const Image& image) const;
};

/// Parses "auto" (returned as empty) or stops from -1000 to 1000. Throws UsageError, which names
/// `option`.
std::optional<double> parseExposure(const std::string& option, const std::string& text);

/// The exposure in stops that brings the picture to mid-grey (0.18). It uses the mean of log
/// luminance without the darkest and the brightest tenth. Lamps, windows and fireflies are in the
/// latter, so that a noisy picture gets the same exposure as a clean one. Black parts do not count.
/// 0 for a black picture.
double automaticExposure(const Image& image);

/// The screen's linear output, each channel in [0, 1], for a radiance times `scale` (2^stops). Values below 0 and NaN
/// become 0.
std::array<double, 3> toned(const Rgb& radiance, double scale, Tone tone);

/// The sRGB transfer functions of IEC 61966-2-1 on [0, 1].
double srgbToLinear(double v);
double linearToSrgb(double v);

/// The bytes of a .png: top row first, three channels of one byte or (16 bits) two, high byte first. With `alpha` (may
/// be null) there are four channels. The picture's colours are premultiplied by alpha, and a .png's are not: they are
/// divided by it, and black where it is 0.
std::vector<std::uint8_t> developed(const Image& image, const PngStyle& style,
                                    const std::vector<float>* alpha = nullptr);

}  // namespace lacuna
