#include "render/study/embed.h"

#include <Imath/half.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lacuna {

namespace {
constexpr double kBytesPerPixel = 3 * 2 * 4.0 / 3.0;  // as halves in base64
}

double meanOf(const Image& image) {
    double sum = 0.0;
    for (const Rgb& p : image.pixels) sum += double(p.r) + double(p.g) + double(p.b);
    return sum / (3.0 * double(image.pixels.size()));
}

int shrinkFactor(double pixels, double bytes) {
    return std::max(1, int(std::ceil(std::sqrt(pixels * kBytesPerPixel / bytes))));
}

int stopsFor(double mean) {
    return mean > 0.0 ? -int(std::floor(std::log2(mean))) - 1 : 0;
}

/// Halves range from 6e-8 to 65504: NaN becomes 0, and values that are too large become the
/// largest.
std::string pixelsText(const Image& image, int stops) {
    const double factor = std::exp2(stops);
    std::string bytes;
    bytes.reserve(image.pixels.size() * 6);
    for (const Rgb& p : image.pixels) {
        for (const float value : {p.r, p.g, p.b}) {
            const double scaled = std::isnan(value) ? 0.0 : double(value) * factor;
            const auto bits = Imath::half(float(std::clamp(scaled, -65504.0, 65504.0))).bits();
            bytes += char(bits & 0xff);
            bytes += char(bits >> 8);
        }
    }
    return base64(bytes);
}

std::string base64(std::string_view bytes) {
    constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8 | (k < n ? std::uint8_t(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += k <= n ? kDigits[group >> (18 - 6 * k) & 63] : '=';
        }
    }
    return text;
}

Image shrunk(const Image& image, int n) {
    Image small(std::max(1, image.width / n), std::max(1, image.height / n));
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            const int x1 = std::min(image.width, (x + 1) * n);
            const int y1 = std::min(image.height, (y + 1) * n);
            double sum[3] = {};
            for (int v = y * n; v < y1; ++v) {
                for (int u = x * n; u < x1; ++u) {
                    const Rgb& p = image.at(u, v);
                    sum[0] += p.r, sum[1] += p.g, sum[2] += p.b;
                }
            }
            const double count = double(x1 - x * n) * double(y1 - y * n);
            small.at(x, y) =
                Rgb(float(sum[0] / count), float(sum[1] / count), float(sum[2] / count));
        }
    }
    return small;
}

}  // namespace lacuna
