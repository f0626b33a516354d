// How many subpaths are under way together.
#pragma once

namespace lacuna {

/// Subpaths that a thread has under way at once; also the side of a tile of pixels.
inline constexpr int kTile = 16;

}  // namespace lacuna
