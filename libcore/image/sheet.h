// A contact sheet: every layer of a picture, small and with its name.
#pragma once

#include "libcore/image/image.h"
#include "libcore/image/label.h"
#include "libcore/image/tone.h"

namespace lacuna {

/// Shows the picture first, then its layers by name. Layers of radiance have the picture's exposure and tone. Variances
/// are shown as noise in the colours of error maps: their root relative to the picture. In Z, near is white. In
/// position, red, green and blue are x, y and z relative to the visible extent. In Cryptomattes each name has its own
/// colour. Throws std::invalid_argument if there is no picture (R, G, B).
Canvas layerSheet(const LayeredImage& image, const PngStyle& style);

}  // namespace lacuna
