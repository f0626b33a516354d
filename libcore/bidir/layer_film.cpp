#include "libcore/bidir/layer_film.h"

#include <algorithm>

#include "libcore/base/parallel.h"

namespace lacuna {

LayerFilm::LayerFilm(const PathLayers& layers, int width, int height, std::uint64_t noiseSample)
    : layers_(layers),
      width_(width),
      height_(height),
      now_(layers.names().size(), std::vector<Rgb>(std::size_t(width) * std::size_t(height))),
      sums_(now_) {
    if (noiseSample == 0) return;
    products_.emplace(layers.lightGroups(), std::size_t(width) * std::size_t(height), noiseSample);
}

void LayerFilm::countIteration(const ThreadPool& threads) {
    ++iterations_;
    if (products_) products_->add(now_, threads);
    const auto width = std::size_t(width_);
    threads.forEach(sums_.size() * std::size_t(height_), [&](std::size_t row) {
        const std::size_t layer = row % sums_.size(), begin = row / sums_.size() * width;
        for (std::size_t i = begin; i < begin + width; ++i) {
            sums_[layer][i] += now_[layer][i];
            now_[layer][i] = {};
        }
    });
}

Layers LayerFilm::means() const {
    LayeredImage image(width_, height_);
    for (std::size_t layer = 0; layer < sums_.size(); ++layer) {
        image.setRgb(layers_.names()[layer], meanOfSum(sums_[layer], iterations_, width_, height_));
    }
    if (products_) products_->setMeans(image);
    return image.channels();
}

void LayerFilm::clear() {
    for (auto* planes : {&now_, &sums_}) {
        for (std::vector<Rgb>& plane : *planes) std::ranges::fill(plane, Rgb{});
    }
    if (products_) products_->clear();
    iterations_ = 0;
}

}  // namespace lacuna
