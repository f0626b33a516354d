// Pictures in memory: row-major, top row first; linear Rec. 709, 32-bit float.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

/// The largest picture that is read or written: a corrupt header must not cause arbitrary
/// allocations.
inline constexpr int kMaxImageSide = 65536;
inline constexpr std::size_t kMaxImagePixels = std::size_t(1) << 28;

/// In pixels.
struct ImageSize {
    int width = 0;
    int height = 0;

    friend bool operator==(ImageSize, ImageSize) = default;
};

/// An RGB picture: `pixels` has width * height entries, pixel (x, y) at [y * width + x].
struct Image {
    int width = 0;
    int height = 0;
    std::vector<Rgb> pixels;

    Image() = default;
    Image(int width_, int height_, const Rgb& fill = Rgb());

    Rgb& at(int x, int y) { return pixels[index(x, y)]; }
    const Rgb& at(int x, int y) const { return pixels[index(x, y)]; }
    bool empty() const { return pixels.empty(); }
    ImageSize size() const { return {width, height}; }

  private:
    std::size_t index(int x, int y) const { return std::size_t(y) * width + x; }
};

using Attribute = std::variant<std::string, double, int>;

/// Named float channels of one size ("R", "albedo.G", "normal.X", "Z", "weighted.s02t03.B"), with
/// header attributes. A channel's layer is the part of its name before the last dot; the layer ""
/// is the picture itself.
class LayeredImage {
  public:
    LayeredImage() = default;
    /// Throws std::invalid_argument for sizes outside 1..kMaxImageSide or above kMaxImagePixels.
    LayeredImage(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }

    /// The channel of that name, width * height floats. A missing one is created with zeros. Throws
    /// std::invalid_argument for a name that EXR cannot hold (empty, above 255 bytes, NUL).
    std::vector<float>& channel(const std::string& name);
    /// nullptr if there is none.
    const std::vector<float>* find(const std::string& name) const;
    const std::map<std::string, std::vector<float>>& channels() const { return channels_; }

    /// Removes a channel and returns its values. Throws std::invalid_argument if there is none.
    std::vector<float> take(const std::string& name);
    /// Sets LAYER.R, LAYER.G, LAYER.B. Throws std::invalid_argument if the sizes differ.
    void setRgb(const std::string& layer, const Image& image);
    bool hasRgb(const std::string& layer) const;
    /// LAYER.R, LAYER.G, LAYER.B as a picture. Throws std::invalid_argument if one is missing.
    Image rgb(const std::string& layer = "") const;

    /// Header attributes. OpenEXR's own names (channels, dataWindow, version, type, ...) are
    /// refused when the file is written.
    std::map<std::string, Attribute> attributes;

  private:
    int width_ = 0;
    int height_ = 0;
    std::map<std::string, std::vector<float>> channels_;
};

}  // namespace lacuna
