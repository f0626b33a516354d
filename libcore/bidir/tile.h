// How many subpaths are traced together.
#pragma once

namespace lacuna {

/// Subpaths that a thread traces at once; also the side of a tile of pixels.
inline constexpr int kTile = 16;

}  // namespace lacuna
