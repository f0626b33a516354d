// How much of the scene a pixel sees.
#pragma once

#include "libcore/bidir/walk.h"

namespace lacuna {

/// Side of a square that a pixel sees where it looks straight at it: the median over the film, at
/// the first vertex that a connection may end at, mirrors and smooth glass passed (scene unit).
/// A function of scene and camera. A thousandth of the scene where nothing is seen.
double medianFootprint(const Walker& walker);

}  // namespace lacuna
