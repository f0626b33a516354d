// Which walks pixels beside each other share, as far as weights have to know. (theory.md, "Shared
// walks")
#pragma once

#include "libcore/bidir/path.h"

namespace lacuna {

struct FullPath;

/// How a row's pixels share their eye walks; fixed for the render.
struct Sharing {
    int pixels = 1;  ///< of a group, a divisor of kTile; 1: every pixel walks alone
    /// How many samples a strategy whose eye walk is shared counts as, beside one that is not.
    double samples = 1.0;

    bool any() const { return pixels > 1; }
};

/// Whether an eye walk may go on from the vertex along another pixel's walk, which lies in no narrow lobe.
inline bool forks(const PathVertex& v) {
    return v.scattersWidely();
}

/// Whether another pixel's walk may go on from the vertex, which that pixel sees from elsewhere.
inline bool mayBeShared(const PathVertex& v) {
    return forks(v) && !v.bsdf.transmits();
}

/// i of the edge x_i, x_{i-1} that is shared where the eye's walk makes it, which strategies of
/// s < i do: x_i is the first vertex from the eye whose event is no delta, and x_{i-1} is none
/// either. Zero where there is none, and for a walk that ends on a lamp at x_0.
int sharedEdge(const FullPath& path);

}  // namespace lacuna
