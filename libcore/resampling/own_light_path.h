// Every pixel's own light subpath: what bpt and vcm have in common. (theory.md, "bpt")
//
// Every eye vertex is connected to each vertex of the pixel's light subpath (M = 1, all are proposed
// with weight 1, so r = 1). With next_event a fresh light point per eye vertex takes the place of the own y_0, so that
// direct light along an eye path is not correlated. There r = 1 as well if lamps are picked by power; otherwise r is
// the quotient of the densities.
#pragma once

#include <memory>

#include "libcore/bidir/method.h"

namespace lacuna {

struct OwnLightPathOptions {
    bool nextEvent = true;
    Lamps lamps = Lamps::Seen;
    Merging merging = {};
};

/// Where it merges, the light subpaths of all pixels are the pool.
std::unique_ptr<Method> makeOwnLightPath(const OwnLightPathOptions& options);

}  // namespace lacuna
