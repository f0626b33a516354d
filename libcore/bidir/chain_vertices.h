// A chain of mirrors and smooth glass as a light walk would have left it.
#pragma once

#include <vector>

#include "libcore/bidir/walk.h"
#include "libcore/specular/chain_solver.h"

namespace lacuna {

/// A vertex as a light walk would have left it, but for densities and its index.
PathVertex vertexOf(const Walker& walker, const ChainVertex& from);

/// Appends y_1 .. behind y_0, the last one where the chain begins, with the densities of both walks;
/// pdfReverseA of the last one is left as it is. Returns the density per solid angle of what leaves it.
float appendChain(const Walker& walker, const Chain& chain, std::vector<PathVertex>& light);

/// What comes from y_0 over the chain to z, where it begins, and is scattered there by `atEye`, over the
/// densities of y_0 and of z's own walk. `light` ends with the chain.
Rgb broughtBy(const Walker& walker, const FoundChain& found, Subpath light, const PathVertex& z,
              const Rgb& atEye);
/// Density of the walk from z along the chain to y_0, per what its direction at z has: by the events'
/// probabilities, and by how far the chain spreads a solid angle.
double walkDensity(const Walker& walker, const FoundChain& found, const PathVertex& y0);
/// Whether all edges from y_0 to z are open, by a ray each.
bool isOpen(const Walker& walker, Subpath light, const PathVertex& z, RayTally& tally);

}  // namespace lacuna
