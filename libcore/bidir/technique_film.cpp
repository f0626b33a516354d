#include "libcore/bidir/technique_film.h"

#include <algorithm>
#include <cstdio>

namespace lacuna {

TechniqueFilm::TechniqueFilm(int width, int height, int maxDepth)
    : width_(width), height_(height), maxDepth_(maxDepth) {
    const std::size_t techniques = indexOf(0, maxDepth + 1) + std::size_t(maxDepth) + 1;
    layers_.assign(2 * techniques, std::vector<Rgb>(std::size_t(width) * height));
}

std::string TechniqueFilm::layerName(int s, int t) {
    char name[32];
    std::snprintf(name, sizeof name, "s%02dt%02d", s, t);
    return name;
}

std::size_t TechniqueFilm::indexOf(int s, int t) const {
    // Paths of k = s + t - 1 edges have k + 1 techniques, s = 0 .. k.
    const int k = s + t - 1;
    return std::size_t(k - 1) * std::size_t(k + 2) / 2 + std::size_t(s);
}

void TechniqueFilm::add(int s, int t, std::uint32_t pixel, const Rgb& weighted,
                        const Rgb& unweighted) {
    const std::size_t i = 2 * indexOf(s, t);
    layers_[i][pixel] += weighted;
    layers_[i + 1][pixel] += unweighted;
}

Image TechniqueFilm::mean(int s, int t, bool unweighted) const {
    Image image(width_, height_);
    const std::vector<Rgb>& layer = layers_[2 * indexOf(s, t) + (unweighted ? 1 : 0)];
    const float scale = iterations_ ? 1.0f / float(iterations_) : 0.0f;
    for (std::size_t i = 0; i < layer.size(); ++i) image.pixels[i] = layer[i] * scale;
    return image;
}

Layers TechniqueFilm::means() const {
    LayeredImage image(width_, height_);
    for (int k = 1; k <= maxDepth_; ++k) {
        for (int s = 0; s <= k; ++s) {
            const int t = k + 1 - s;
            if (std::ranges::all_of(layers_[2 * indexOf(s, t) + 1], isBlack)) continue;
            image.setRgb("weighted." + layerName(s, t), mean(s, t, false));
            image.setRgb("unweighted." + layerName(s, t), mean(s, t, true));
        }
    }
    return image.channels();
}

void TechniqueFilm::clear() {
    for (std::vector<Rgb>& layer : layers_) std::ranges::fill(layer, Rgb{});
    iterations_ = 0;
}

void addShareOfFirstConnections(LayeredImage& image, int maxDepth) {
    const std::size_t pixels = std::size_t(image.width()) * std::size_t(image.height());
    std::vector<double> total(pixels, 0.0), first(pixels, 0.0);  // of the channels, over layers
    for (int k = 1; k <= maxDepth; ++k) {
        for (int s = 0; s <= k; ++s) {
            const int t = k + 1 - s;
            const std::string layer = "weighted." + TechniqueFilm::layerName(s, t);
            if (!image.hasRgb(layer)) continue;
            for (const char* channel : {".R", ".G", ".B"}) {
                const std::vector<float>& plane = *image.find(layer + channel);
                for (std::size_t i = 0; i < pixels; ++i) {
                    total[i] += double(plane[i]);
                    if (t == 2 && s > 0) first[i] += double(plane[i]);
                }
            }
        }
    }
    std::vector<float>& share = image.channel("share.t02");
    for (std::size_t i = 0; i < pixels; ++i) {
        share[i] = total[i] > 0.0 ? float(first[i] / total[i]) : 0.0f;
    }
}

}  // namespace lacuna
