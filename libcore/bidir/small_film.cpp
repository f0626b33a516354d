#include "libcore/bidir/small_film.h"

#include <algorithm>
#include <cmath>

namespace lacuna {

SmallFilm::SmallFilm(const Camera::Film& whole, const PixelRect& asked, double pixels) {
    const double area = double(asked.width()) * double(asked.height());
    const double factor = std::min(1.0, std::sqrt(pixels / area));
    const auto scaled = [&](int side) {
        return std::max(1, int(std::lround(double(side) * factor)));
    };
    film = {scaled(whole.width), scaled(whole.height)};
    const double across = double(film.width) / double(whole.width);
    const double down = double(film.height) / double(whole.height);
    const auto begin = [](int side, double f, int most) {
        return std::clamp(int(std::floor(double(side) * f)), 0, most - 1);
    };
    crop.x0 = begin(asked.x0, across, film.width);
    crop.y0 = begin(asked.y0, down, film.height);
    crop.x1 = std::clamp(int(std::lround(double(asked.x1) * across)), crop.x0 + 1, film.width);
    crop.y1 = std::clamp(int(std::lround(double(asked.y1) * down)), crop.y0 + 1, film.height);
    scale = area / (double(crop.width()) * double(crop.height()));
}

}  // namespace lacuna
