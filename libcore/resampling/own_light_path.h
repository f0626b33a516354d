// Every pixel's own light subpath: what bpt and vcm have in common. (theory.md, "bpt")
//
// Every eye vertex is connected to each vertex of the pixel's light subpath (M = 1, all are proposed
// with weight 1, so r = 1). With next_event the own y_0 makes way for a fresh light point per eye
// vertex, without the correlation of all direct light along an eye path: r = 1 as well where lamps
// are picked by power, else the quotient of the densities.
#pragma once

#include <memory>

#include "libcore/bidir/method.h"

namespace lacuna {

struct OwnLightPathOptions {
    bool nextEvent = true;
    Lamps lamps = Lamps::Seen;
    Merging merging = {};
};

/// Merging: the light subpaths of all pixels are the pool.
std::unique_ptr<Method> makeOwnLightPath(const OwnLightPathOptions& options);

}  // namespace lacuna
