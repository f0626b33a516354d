// A page that shows every layer of a picture, small and with its name.
#pragma once

#include "libcore/image/image.h"
#include "libcore/image/label.h"
#include "libcore/image/tone.h"

namespace lacuna {

/// The picture first, then the layers that belong to it, by name; layers of radiance have the
/// picture's exposure and tone. Variances are shown as noise, in the colours of error maps: their
/// root against the picture. Of Z near is white; of position red, green and blue say how far along x, y
/// and z of what is seen; of Cryptomatte each name has a colour of its own. Throws std::invalid_argument where there is no picture (R, G, B).
Canvas layerSheet(const LayeredImage& image, const PngStyle& style);

}  // namespace lacuna
