#include "libcore/bidir/light_group_film.h"

#include <algorithm>

#include "libcore/base/parallel.h"

namespace lacuna {

LightGroupFilm::LightGroupFilm(LightGroups groups, int width, int height)
    : groups_(std::move(groups)),
      width_(width),
      height_(height),
      now_(groups_.names.size(), std::vector<Rgb>(std::size_t(width) * std::size_t(height))),
      sums_(now_) {}

void LightGroupFilm::countIteration(const ThreadPool& threads) {
    ++iterations_;
    const auto width = std::size_t(width_);
    threads.forEach(sums_.size() * std::size_t(height_), [&](std::size_t row) {
        const std::size_t group = row % sums_.size(), begin = row / sums_.size() * width;
        for (std::size_t i = begin; i < begin + width; ++i) {
            sums_[group][i] += now_[group][i];
            now_[group][i] = {};
        }
    });
}

Layers LightGroupFilm::means() const {
    LayeredImage image(width_, height_);
    for (std::size_t group = 0; group < sums_.size(); ++group) {
        image.setRgb(layerName(groups_.names[group]),
                     meanOfSum(sums_[group], iterations_, width_, height_));
    }
    return image.channels();
}

void LightGroupFilm::clear() {
    for (auto* planes : {&now_, &sums_}) {
        for (std::vector<Rgb>& plane : *planes) std::ranges::fill(plane, Rgb{});
    }
    iterations_ = 0;
}

}  // namespace lacuna
