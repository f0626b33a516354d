#include "render/study/pictures.h"

#include <Imath/half.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "libcore/image/image_io.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr double kBytesPerPixel = 3 * 2 * 4.0 / 3.0;  // halves in base64

Image cropped(const Image& image, const PixelRect& rect) {
    if (image.width == rect.width() && image.height == rect.height()) return image;
    Image part(rect.width(), rect.height());
    for (int y = 0; y < part.height; ++y) {
        for (int x = 0; x < part.width; ++x) part.at(x, y) = image.at(rect.x0 + x, rect.y0 + y);
    }
    return part;
}

double meanOf(const Image& image) {
    double sum = 0.0;
    for (const Rgb& p : image.pixels) sum += double(p.r) + double(p.g) + double(p.b);
    return sum / (3.0 * double(image.pixels.size()));
}

/// Halves reach from 6e-8 to 65504: NaN becomes 0, what is too large the largest.
std::string halves(const Image& image, double factor) {
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
    return bytes;
}

/// By how much all pictures have to be shrunk to stay within the page's share.
int shrinkFactor(const Results& results) {
    double pixels = 0.0;
    for (const SceneFacts& facts : results.facts) {
        pixels += double(facts.crop.width()) * double(facts.crop.height()) *
                  double(results.study.methods.size() + 1);
    }
    return std::max(1, int(std::ceil(std::sqrt(pixels * kBytesPerPixel / kPictureBytes))));
}

}  // namespace

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

json picturesJson(const Results& results) {
    json scenes = json::array();
    const int n = shrinkFactor(results);
    for (std::size_t s = 0; s < results.study.scenes.size(); ++s) {
        const Image reference =
            shrunk(cropped(readImage(results.references[s].path), results.facts[s].crop), n);
        const double mean = meanOf(reference);
        const int stops = mean > 0.0 ? -int(std::floor(std::log2(mean))) - 1 : 0;
        const double factor = std::exp2(stops);
        json pictures = json::array();
        const auto add = [&](const std::string& name, int method, std::uint64_t seed,
                             const Image& image) {
            pictures.push_back({{"name", name},
                                {"method", method},
                                {"seed", seed},
                                {"pixels", base64(halves(image, factor))}});
        };
        add("reference", -1, 0, reference);
        for (std::size_t m = 0; m < results.study.methods.size(); ++m) {
            const RunResult& run = *results.of(s, m).front();
            add(results.study.methods[m].name, int(m), run.run.seed,
                shrunk(readImage(run.image), n));
        }
        scenes.push_back({{"width", reference.width},
                          {"height", reference.height},
                          {"shrink", n},
                          {"stops", stops},
                          {"pictures", std::move(pictures)}});
    }
    return scenes;
}

}  // namespace lacuna
