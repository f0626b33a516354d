#include "libcore/image/tone.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/base/number_text.h"

namespace lacuna {
namespace {

constexpr double kMidGrey = 0.18;
constexpr double kWhite = 16.0;    // 6.5 stops above mid-grey
constexpr double kContrast = 1.2;  // slope of the dark end in stops
/// Share of grey that is mixed into each channel: bright colours approach white, as on film,
/// instead of ending at a pure red, green or blue.
constexpr double kCrosstalk = 0.05;

double luminance(const Rgb& v) {
    return 0.2126 * double(v.r) + 0.7152 * double(v.g) + 0.0722 * double(v.b);
}

/// A saturating power of the exposure: u (1 + k) / (u + k), u = (v / white)^contrast. k is such
/// that mid-grey is unchanged.
double filmic(double v) {
    static const double grey = std::pow(kMidGrey / kWhite, kContrast);
    static const double k = (1.0 - kMidGrey) * grey / (kMidGrey - grey);
    const double u = std::pow(std::min(v, kWhite) / kWhite, kContrast);
    return u * (1.0 + k) / (u + k);
}

}  // namespace

const char* nameOf(Tone tone) {
    return tone == Tone::Standard ? "standard" : "filmic";
}

Tone parseTone(const std::string& option, const std::string& text) {
    for (const Tone tone : {Tone::Standard, Tone::Filmic}) {
        if (text == nameOf(tone)) return tone;
    }
    throw UsageError(option + ": expected standard or filmic, found '" + text + "'");
}

std::optional<double> parseExposure(const std::string& option, const std::string& text) {
    if (text == "auto") return std::nullopt;
    const std::optional<double> stops = parseNumber(text);
    if (!stops || !(std::abs(*stops) <= 1000.0)) {
        throw UsageError(option + ": expected auto, or stops from -1000 to 1000, found '" + text +
                         "'");
    }
    return stops;
}

double PngStyle::stopsFor(const Image& image) const {
    return exposure ? *exposure : automaticExposure(image);
}

double automaticExposure(const Image& image) {
    // Means over cells, not single pixels: where few paths find the light, most pixels of a noisy
    // picture are black and the others too bright.
    constexpr int kCellsAcross = 48;
    const int side = std::max(1, std::max(image.width, image.height) / kCellsAcross);
    std::vector<double> logs;
    for (int y0 = 0; y0 < image.height; y0 += side) {
        for (int x0 = 0; x0 < image.width; x0 += side) {
            double sum = 0.0;
            int count = 0;
            for (int y = y0; y < std::min(y0 + side, image.height); ++y) {
                for (int x = x0; x < std::min(x0 + side, image.width); ++x) {
                    const double value = luminance(image.at(x, y));
                    if (!std::isfinite(value)) continue;
                    sum += std::max(value, 0.0);
                    ++count;
                }
            }
            if (sum > 0.0) logs.push_back(std::log2(sum / count));
        }
    }
    if (logs.empty()) return 0.0;
    std::sort(logs.begin(), logs.end());
    const std::size_t tenth = logs.size() / 10;
    double sum = 0.0;
    for (std::size_t i = tenth; i < logs.size() - tenth; ++i) sum += logs[i];
    return std::log2(kMidGrey) - sum / double(logs.size() - 2 * tenth);
}

std::array<double, 3> toned(const Rgb& radiance, double scale, Tone tone) {
    const double grey = luminance(radiance);
    // If a channel is not finite, channels are not mixed: infinity - infinity would be NaN.
    const double mixed = tone == Tone::Filmic && std::isfinite(grey) ? kCrosstalk : 0.0;
    const auto shown = [&](double v) {
        if (mixed > 0.0) v += mixed * (grey - v);
        v *= scale;
        if (!(v > 0.0)) return 0.0;  // NaN too
        return tone == Tone::Filmic ? filmic(v) : std::min(v, 1.0);
    };
    return {shown(radiance.r), shown(radiance.g), shown(radiance.b)};
}

double srgbToLinear(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

double linearToSrgb(double v) {
    return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

std::vector<std::uint8_t> developed(const Image& image, const PngStyle& style,
                                    const std::vector<float>* alpha) {
    const double scale = std::exp2(style.stopsFor(image));
    const double most = style.bits == 16 ? 65535.0 : 255.0;
    std::vector<std::uint8_t> bytes;
    bytes.reserve(image.pixels.size() * (alpha ? 4 : 3) * std::size_t(style.bits / 8));
    const auto add = [&](double share) {
        const auto code = std::uint16_t(std::lround(most * share));
        if (style.bits == 16) bytes.push_back(std::uint8_t(code >> 8));
        bytes.push_back(std::uint8_t(code & 255));
    };
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const float covered = alpha ? std::clamp((*alpha)[i], 0.0f, 1.0f) : 1.0f;
        const Rgb p = covered > 0.0f ? image.pixels[i] * (1.0f / covered) : Rgb{};
        for (const double v : toned(p, scale, style.tone)) add(linearToSrgb(v));
        if (alpha) add(double(covered));
    }
    return bytes;
}

}  // namespace lacuna
