// Topological invariants: numbers of components, independent loops and enclosed cavities.
#pragma once

#include "libcore/skeleton/cubical_complex.h"

namespace lacuna {

struct Betti {
    std::int64_t b0 = 0;  ///< connected components
    std::int64_t b1 = 0;  ///< independent loops
    std::int64_t b2 = 0;  ///< enclosed cavities
    std::int64_t euler() const { return b0 - b1 + b2; }
    friend bool operator==(const Betti&, const Betti&) = default;
};

/// Betti numbers of the Empty voxels (26-connected; everything else is solid and 6-connected).
/// Components and cavities are counted; the number of loops follows from the Euler characteristic
/// of the complex.
Betti emptySpaceBetti(const VoxelSpace& space);

}  // namespace lacuna
