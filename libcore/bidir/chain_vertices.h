// A chain of mirrors and smooth glass as a light walk would have left it.
#pragma once

#include <vector>

#include "libcore/bidir/walk.h"
#include "libcore/specular/chain.h"

namespace lacuna {

/// Appends y_1 .. behind y_0, the last one where the chain begins, with the densities of both walks;
/// pdfReverseA of the last one is left as it is.
void appendChain(const Walker& walker, const Chain& chain, std::vector<PathVertex>& light);

}  // namespace lacuna
