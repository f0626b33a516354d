// A chain of mirrors and smooth glass as a light walk would have left it. (theory.md, "Next event through glass")
#pragma once

#include <optional>
#include <vector>

#include "libcore/bidir/close.h"
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
/// p(y_0) of one sample by power over what an eye walk that leaves z along the chain has for it, but for the
/// direction's density at z: the events' probabilities, and how far the chain spreads a solid angle. Zero where
/// no walk goes there.
double densityOfNextEvent(const Walker& walker, const FoundChain& found, const PathVertex& y0);
/// Whether all edges from y_0 to z are open, by a ray each.
bool isOpen(const Walker& walker, Subpath light, const PathVertex& z, RayTally& tally);

/// A path over a chain from y_0 to an eye subpath's last vertex.
struct NextEvent {
    Closed closed;   ///< as if y_0 and the chain had density one
    double eyePdfW;  ///< of the direction at that vertex, by its own walk
};
/// Empty where it carries nothing. Fills `light`, y_0 .. , and `path`, but for FullPath::refracted.
std::optional<NextEvent> closeNextEvent(const Walker& walker, const FoundChain& found,
                                        const PathVertex& y0, Subpath eye, RayTally& tally,
                                        std::vector<PathVertex>& light, FullPath& path);

}  // namespace lacuna
