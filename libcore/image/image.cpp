#include "libcore/image/image.h"

#include <array>
#include <stdexcept>
#include <utility>

namespace lacuna {
namespace {

std::array<std::string, 3> rgbNames(const std::string& layer) {
    const std::string prefix = layer.empty() ? "" : layer + ".";
    return {prefix + "R", prefix + "G", prefix + "B"};
}

/// Number of pixels. Throws std::invalid_argument if the sizes are out of range.
std::size_t checkedPixels(int width, int height) {
    if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide ||
        std::size_t(width) * std::size_t(height) > kMaxImagePixels) {
        throw std::invalid_argument("image of " + std::to_string(width) + " x " +
                                    std::to_string(height) + " pixels");
    }
    return std::size_t(width) * std::size_t(height);
}

}  // namespace

Image::Image(int width_, int height_, const Rgb& fill)
    : width(width_), height(height_), pixels(checkedPixels(width_, height_), fill) {}

LayeredImage::LayeredImage(int width, int height) : width_(width), height_(height) {
    checkedPixels(width, height);
}

std::vector<float>& LayeredImage::channel(const std::string& name) {
    if (name.empty() || name.size() > 255 || name.find('\0') != std::string::npos) {
        throw std::invalid_argument("channel name '" + name + "'");
    }
    std::vector<float>& values = channels_[name];
    values.resize(std::size_t(width_) * std::size_t(height_));
    return values;
}

const std::vector<float>* LayeredImage::find(const std::string& name) const {
    const auto found = channels_.find(name);
    return found == channels_.end() ? nullptr : &found->second;
}

std::vector<float> LayeredImage::take(const std::string& name) {
    const auto found = channels_.find(name);
    if (found == channels_.end()) throw std::invalid_argument("no channel " + name);
    std::vector<float> values = std::move(found->second);
    channels_.erase(found);
    return values;
}

void LayeredImage::setRgb(const std::string& layer, const Image& image) {
    if (image.width != width_ || image.height != height_) {
        throw std::invalid_argument("layer '" + layer + "' of another size than its image");
    }
    const auto names = rgbNames(layer);
    std::vector<float>&r = channel(names[0]), &g = channel(names[1]), &b = channel(names[2]);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        r[i] = image.pixels[i].r;
        g[i] = image.pixels[i].g;
        b[i] = image.pixels[i].b;
    }
}

bool LayeredImage::hasRgb(const std::string& layer) const {
    const auto names = rgbNames(layer);
    return find(names[0]) && find(names[1]) && find(names[2]);
}

Image LayeredImage::rgb(const std::string& layer) const {
    if (!hasRgb(layer)) throw std::invalid_argument("no RGB layer '" + layer + "'");
    const auto names = rgbNames(layer);
    const std::vector<float>&r = *find(names[0]), &g = *find(names[1]), &b = *find(names[2]);
    Image image(width_, height_);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = {r[i], g[i], b[i]};
    return image;
}

}  // namespace lacuna
