// The same picture in fewer pixels, for estimates that are made before a render.
#pragma once

#include "libcore/bidir/film.h"
#include "libcore/scene/camera.h"

namespace lacuna {

inline double pixelsOf(const Camera::Film& film) {
    return double(film.width) * double(film.height);
}

struct SmallFilm {
    /// A film whose crop has about `pixels` pixels, but no more than `crop` of `whole` has.
    SmallFilm(const Camera::Film& whole, const PixelRect& crop, double pixels);
    /// Likewise, of the whole film.
    SmallFilm(const Camera::Film& whole, double pixels)
        : SmallFilm(whole, {0, whole.width, 0, whole.height}, pixels) {}

    Camera::Film film;  ///< the whole picture
    PixelRect crop;     ///< the part of it that was asked for
    double scale;       ///< pixels of the crop that was asked for, per pixel of this one
};

}  // namespace lacuna
