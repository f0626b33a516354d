// The vertices of a chain of mirrors and smooth glass, as a light walk would have left them.
// (theory.md, "Next event through glass")
#pragma once

#include <optional>
#include <vector>

#include "libcore/bidir/close.h"
#include "libcore/specular/chain_solver.h"

namespace lacuna {

/// A vertex as a light walk would have left it, but for densities and its index.
PathVertex vertexOf(const Walker& walker, const ChainVertex& from);

/// Appends the chain's vertices y_1 .. behind y_0, with the densities of both walks. The last one is the vertex where
/// the chain begins, next to z; its pdfReverseA is not set. Returns the density (pdfW) of the direction in which light
/// leaves that vertex.
float appendChain(const Walker& walker, const Chain& chain, std::vector<PathVertex>& light);

/// Contribution of the path from y_0 over the chain to z, divided by the densities of y_0 and of z's own walk. `light`
/// is y_0 and the chain's vertices, `atEye` the value of the BSDF at z.
Rgb broughtBy(const Walker& walker, const FoundChain& found, Subpath light, const PathVertex& z,
              const Rgb& atEye);
/// Ratio of two densities of y_0: that of a point picked by power over that of an eye walk that leaves z along the
/// chain. The walk's density has the events' probabilities and the chain's spread of solid angle as factors, but not
/// the density of the direction at z. Zero where no walk goes there.
double densityOfNextEvent(const Walker& walker, const FoundChain& found, const PathVertex& y0);
/// Whether all edges from y_0 to z are open. Traces one ray per edge.
bool isOpen(const Walker& walker, Subpath light, const PathVertex& z, RayTally& tally);

/// A path over a chain from y_0 to an eye subpath's last vertex.
struct NextEvent {
    Closed closed;   ///< as if y_0 and the chain had density one
    double eyePdfW;  ///< pdfW of the chain's first direction at that vertex, by the eye's walk
};
/// Closes the path from the last vertex of `eye` over the chain to `y0`. Empty where it carries
/// nothing. Fills `light` (y_0 and the chain's vertices) and all of `path` but FullPath::refracted.
std::optional<NextEvent> closeNextEvent(const Walker& walker, const FoundChain& found,
                                        const PathVertex& y0, Subpath eye, RayTally& tally,
                                        std::vector<PathVertex>& light, FullPath& path);

}  // namespace lacuna
