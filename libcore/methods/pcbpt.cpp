// Probabilistic connections [Popov15], as [Nabata20a] and [Nabata20b] compare with them. Light
// vertices are resampled at cache points, under the weights of plain bidirectional path tracing (r
// = 1). See cache_resampling.h. The preset has [Popov15]'s own target, with the cache point's BSDF.
// Nabata et al. use the target of their own methods, `flow`. (theory.md, "pcbpt")
#include "libcore/methods/registry.h"
#include "libcore/resampling/cache_resampling.h"

namespace lacuna {

MethodRow pcbptRow() {
    return methodRow(
        {.name = "pcbpt",
         .reference = "Popov15",
         .summary = "probabilistic connections: resamples light vertices at nearby cache points",
         .techniques = {.hits = true, .connects = true, .splats = true},
         .paper = {"first_connections=0", "lamps=power", "next_event=off", "target=flow-bsdf"}},
        cacheResamplingOptions({.subpaths = 100}), makeCacheResampling);
}

}  // namespace lacuna
