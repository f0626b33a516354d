// How much of the scene a pixel sees.
#pragma once

#include "libcore/bidir/walk.h"

namespace lacuna {

/// Side of the square that a pixel sees on a surface at right angles to its ray, in scene units:
/// the median over the film. The surface is the first vertex that a connection may end at, behind
/// mirrors and smooth glass. A function of scene and camera. A thousandth of the scene's radius
/// where nothing is seen.
double medianFootprint(const Walker& walker);

}  // namespace lacuna
