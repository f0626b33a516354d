// How pixels beside each other share eye walks, as far as weights have to know. (theory.md,
// "Shared walks")
#pragma once

#include "libcore/bidir/path.h"

namespace lacuna {

struct FullPath;

/// Factor of n r of the strategies whose eye walk is shared.
constexpr double kSharedSamples = 4.0;

/// How a row's pixels share their eye walks; fixed for the render.
struct Sharing {
    int pixels = 1;  ///< of a group, a divisor of kTile; 1: every pixel walks alone

    bool any() const { return pixels > 1; }
};

/// Whether an eye walk may go on from the vertex along another pixel's walk. A narrow lobe does not lead there.
inline bool forks(const PathVertex& v) {
    return v.scattersWidely();
}

/// Whether another pixel's walk, which arrives from elsewhere, may go on from the vertex.
inline bool mayBeShared(const PathVertex& v) {
    return forks(v) && !v.bsdf.transmits();
}

/// Index i of the edge from x_i to x_{i-1} that pixels share where the eye's walk makes it, as
/// in strategies with s < i. x_i is the first vertex from the eye whose event is no delta; the
/// event at x_{i-1} is none either. Zero where there is no such edge, and for a walk that ends
/// on a lamp at x_0.
int sharedEdge(const FullPath& path);

}  // namespace lacuna
