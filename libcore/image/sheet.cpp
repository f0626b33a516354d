#include "libcore/image/sheet.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "libcore/image/cryptomatte.h"
#include "libcore/image/error_map.h"

namespace lacuna {
namespace {

constexpr Colour8 kGround{34, 34, 38}, kInk{225, 225, 225};
constexpr int kGap = 12;

/// Channels of one layer: three of them as a colour or a vector, or one alone.
struct Layer {
    std::string name;  ///< as in the channels' names: "" is the picture
    std::vector<const std::vector<float>*> planes;
};

/// The layers of one image, sorted by name.
std::vector<Layer> layersByName(const LayeredImage& image) {
    std::vector<Layer> layers;
    for (const auto& [channel, plane] : image.channels()) {
        if (channel.starts_with("covariance.")) continue;  // not pictures: signed, and many
        const std::size_t dot = channel.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : channel.substr(0, dot);
        const std::string part = dot == std::string::npos ? channel : channel.substr(dot + 1);
        const auto other = [&](const char* name) {
            return image.find(layer.empty() ? name : layer + "." + name);
        };
        if (layer.starts_with("Crypto") && other("A")) continue;  // ids
        const bool colour = other("R") && other("G") && other("B");
        const bool vector = !layer.empty() && other("X") && other("Y") && other("Z");
        if (colour && (part == "R" || part == "G" || part == "B")) {
            if (part == "R") layers.push_back({layer, {&plane, other("G"), other("B")}});
        } else if (vector && (part == "X" || part == "Y" || part == "Z")) {
            if (part == "X") layers.push_back({layer, {&plane, other("Y"), other("Z")}});
        } else {
            layers.push_back({channel, {&plane}});
        }
    }
    return layers;
}

/// All layers in the order of the sheet. `ids`: the Cryptomattes as pictures.
std::vector<Layer> layersOf(const LayeredImage& image, const LayeredImage& ids) {
    std::vector<Layer> layers = layersByName(image);
    for (Layer& layer : layersByName(ids)) layers.push_back(std::move(layer));
    const auto rank = [](const Layer& l) {
        int i = 0;
        for (const char* first : {"", "A", "variance", "albedo", "normal", "Z", "position"}) {
            if (l.name == first) return i;
            ++i;
        }
        return i;
    };
    std::stable_sort(layers.begin(), layers.end(),
                     [&](const Layer& a, const Layer& b) { return rank(a) < rank(b); });
    return layers;
}

/// Size of the small pictures. Their pixels are means over the picture's pixels, or copies where
/// the picture has fewer.
struct Raster {
    int fromWidth, fromHeight, width, height;

    Raster(int w, int h, int longest) : fromWidth(w), fromHeight(h), width(w), height(h) {
        const int larger = std::max(w, h);
        if (larger <= longest) {
            width *= longest / larger;
            height *= longest / larger;
        } else {
            width = std::max(1, int(std::lround(double(w) * longest / larger)));
            height = std::max(1, int(std::lround(double(h) * longest / larger)));
        }
    }

    /// The mean over the picture's pixels under a pixel of the small picture, without values that
    /// are not finite.
    float mean(const std::vector<float>& plane, int x, int y) const {
        const auto range = [](int i, int from, int to) {
            const int begin = int(std::int64_t(i) * from / to);
            return std::pair(begin, std::max(begin + 1, int(std::int64_t(i + 1) * from / to)));
        };
        const auto [x0, x1] = range(x, fromWidth, width);
        const auto [y0, y1] = range(y, fromHeight, height);
        double sum = 0.0;
        int count = 0;
        for (int row = y0; row < y1; ++row) {
            for (int column = x0; column < x1; ++column) {
                const float v =
                    plane[std::size_t(row) * std::size_t(fromWidth) + std::size_t(column)];
                if (!std::isfinite(v)) continue;
                sum += double(v);
                ++count;
            }
        }
        return count > 0 ? float(sum / count) : 0.0f;
    }
};

Image shrunk(const Layer& layer, const Raster& raster) {
    Image small(raster.width, raster.height);
    for (int y = 0; y < raster.height; ++y) {
        for (int x = 0; x < raster.width; ++x) {
            const float first = raster.mean(*layer.planes.front(), x, y);
            small.at(x, y) = layer.planes.size() == 3
                                 ? Rgb(first, raster.mean(*layer.planes[1], x, y),
                                       raster.mean(*layer.planes[2], x, y))
                                 : Rgb(first);
        }
    }
    return small;
}

std::uint8_t byteOf(double share) {
    return std::uint8_t(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
}

Colour8 screen(const Rgb& radiance, double scale, Tone tone) {
    const std::array<double, 3> shown = toned(radiance, scale, tone);
    return {byteOf(linearToSrgb(shown[0])), byteOf(linearToSrgb(shown[1])),
            byteOf(linearToSrgb(shown[2]))};
}

std::string text(const char* format, double a, double b = 0.0) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, format, a, b);
    return buffer;
}

/// Smallest and largest of the values above 0; (0, 0) if there are none.
std::pair<float, float> rangeOf(const Image& small) {
    float low = 0.0f, high = 0.0f;
    for (const Rgb& p : small.pixels) {
        if (!(p.r > 0.0f)) continue;
        low = low > 0.0f ? std::min(low, p.r) : p.r;
        high = std::max(high, p.r);
    }
    return {low, high};
}

/// Bounding box of the positions in a picture, without the origin, which means that nothing is
/// there.
struct Box {
    Rgb low, high;

    Colour8 colour(const Rgb& p) const {
        const auto share = [](float v, float from, float to) {
            return byteOf(to > from ? double(v - from) / double(to - from) : 0.5);
        };
        if (isBlack(p)) return {0, 0, 0};
        return {share(p.r, low.r, high.r), share(p.g, low.g, high.g), share(p.b, low.b, high.b)};
    }
};
Box boxOf(const Image& positions) {
    Box box{Rgb(std::numeric_limits<float>::max()), Rgb(std::numeric_limits<float>::lowest())};
    for (const Rgb& p : positions.pixels) {
        if (isBlack(p)) continue;
        box.low = {std::min(box.low.r, p.r), std::min(box.low.g, p.g), std::min(box.low.b, p.b)};
        box.high = {std::max(box.high.r, p.r), std::max(box.high.g, p.g),
                    std::max(box.high.b, p.b)};
    }
    return box;
}

/// Turns layers into visible colours; it needs the picture itself for exposure and noise.
class Show {
  public:
    /// `picture`: the small version of the picture.
    Show(const Image& picture, Tone tone, double stops)
        : picture_(picture), tone_(tone), stops_(stops) {
        double sum = 0.0;
        for (const Rgb& p : picture.pixels) sum += double(mean(p));
        floor_ = 0.01 * sum / double(picture.pixels.size());
    }

    /// Colours of a layer's small picture. Adds an explanation of them to `label`.
    std::vector<Colour8> colours(const Layer& layer, const Image& small, std::string& label) const {
        const auto is = [&](const char* start) { return layer.name.starts_with(start); };
        const auto each = [&](auto&& colour) {
            std::vector<Colour8> out;
            out.reserve(small.pixels.size());
            for (std::size_t i = 0; i < small.pixels.size(); ++i) {
                out.push_back(colour(small.pixels[i], i));
            }
            return out;
        };
        if (layer.name.empty()) label = text("picture, %+.1f stops", stops_);
        if (is("variance")) {
            return each([&](const Rgb& v, std::size_t i) {
                const double level = double(mean(picture_.pixels[i])) + floor_;
                return errorColour(level > 0.0 ? std::sqrt(std::max(0.0, double(mean(v)))) / level
                                               : 0.0);
            });
        }
        if (is("normal")) {
            return each([](const Rgb& n, std::size_t) {
                return Colour8{byteOf(0.5 + 0.5 * double(n.r)), byteOf(0.5 + 0.5 * double(n.g)),
                               byteOf(0.5 + 0.5 * double(n.b))};
            });
        }
        if (layer.name == "position") {
            const Box box = boxOf(small);
            return each([=](const Rgb& p, std::size_t) { return box.colour(p); });
        }
        if (is("albedo") || is("node") || is("subspace") || is("lightSubspace") || is("share") ||
            is("Crypto") || layer.name == "A") {
            return each([](const Rgb& v, std::size_t) { return screen(v, 1.0, Tone::Standard); });
        }
        if (layer.name == "Z") {
            const auto [low, high] = rangeOf(small);
            label += text(" from %.3g to %.3g", double(low), double(high));
            const double least = double(low), span = double(high) - least;
            return each([=](const Rgb& v, std::size_t) {
                const double depth = span > 0.0 ? (double(v.r) - least) / span : 0.0;
                const std::uint8_t grey = v.r > 0.0f ? byteOf(0.95 - 0.8 * depth) : std::uint8_t(0);
                return Colour8{grey, grey, grey};
            });
        }
        const double scale = std::exp2(stops_);
        return each([&](const Rgb& v, std::size_t) { return screen(v, scale, tone_); });
    }

  private:
    const Image& picture_;
    Tone tone_;
    double stops_, floor_ = 0.0;
};

}  // namespace

Canvas layerSheet(const LayeredImage& image, const PngStyle& style) {
    const LayeredImage ids = cryptomattePictures(image);
    const std::vector<Layer> layers = layersOf(image, ids);
    const int count = int(layers.size());
    const Raster raster(image.width(), image.height(), count <= 12 ? 400 : count <= 48 ? 300 : 220);
    if (!image.hasRgb("")) throw std::invalid_argument("sheet: expected channels R, G and B");
    const Image picture = shrunk({"", {image.find("R"), image.find("G"), image.find("B")}}, raster);
    const Show show(picture, style.tone, style.stopsFor(image.rgb()));

    // The sheet is close to 16:9; each cell has a line of text below.
    const int cellWidth = std::max(raster.width, 200) + kGap;
    const int cellHeight = raster.height + Canvas::lineHeight() + kGap;
    const double wanted = std::sqrt(count * 16.0 / 9.0 * cellHeight / cellWidth);
    const int columns = std::clamp(int(std::lround(wanted)), 1, count);
    const int rows = (count + columns - 1) / columns;
    Canvas canvas(columns * cellWidth + kGap, rows * cellHeight + kGap, kGround);
    for (int i = 0; i < count; ++i) {
        const Layer& layer = layers[std::size_t(i)];
        const int left = kGap + i % columns * cellWidth, top = kGap + i / columns * cellHeight;
        std::string label = layer.name;
        const std::vector<Colour8> colours = show.colours(layer, shrunk(layer, raster), label);
        for (int y = 0; y < raster.height; ++y) {
            for (int x = 0; x < raster.width; ++x) {
                canvas.fill(left + x, top + y, 1, 1, colours[std::size_t(y * raster.width + x)]);
            }
        }
        canvas.write(left, top + raster.height + 4, fitted(label, cellWidth - kGap), kInk);
    }
    return canvas;
}

}  // namespace lacuna
