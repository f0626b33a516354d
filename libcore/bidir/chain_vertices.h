// A chain of mirrors and smooth glass as a light walk would have left it.
#pragma once

#include <vector>

#include "libcore/bidir/walk.h"
#include "libcore/specular/chain.h"

namespace lacuna {

/// Appends y_1 .. behind y_0, the last one where the chain begins, with the densities of both walks;
/// pdfReverseA of the last one is left as it is.
void appendChain(const Walker& walker, const Chain& chain, std::vector<PathVertex>& light);

/// Share of the radiance from y_0 that comes to z, where the chain begins: by its events, and by what
/// bodies absorb. `light` ends with the chain.
Rgb shareThrough(const Walker& walker, const Chain& chain, Subpath light, const PathVertex& z);
/// Whether all edges from y_0 to z are open, by a ray each.
bool isOpen(const Walker& walker, Subpath light, const PathVertex& z, RayTally& tally);

}  // namespace lacuna
