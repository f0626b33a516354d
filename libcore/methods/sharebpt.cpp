// Our own: spcbpt whose pixels share eye walks [Bekaert02]. (theory.md, "Shared walks")
//
//   walks     up to 16 pixels of a square share their eye walks: what a walk was joined to behind its first
//             vertex that is no mirror and no smooth glass goes to all pixels that see the next vertex
//   picks     light vertices are picked as in spcbpt
//   weights   a shared walk counts as `kSharedSamples` walks that are not shared
//   numbers   random numbers are even over iterations, unless --sampler says otherwise: the noise that is left
//             is mostly the pixel's own, which they reduce
//   training  it takes seconds: more is not worth its time
#include "libcore/methods/spcbpt.h"
#include "libcore/subspace/training_settings.h"

namespace lacuna {

MethodRow sharebptRow() {
    OptionTable<SubspaceOptions> table = subspaceOptions({.subpaths = 30'000, .sharedPixels = 16});
    table.choice<int>("share", &SubspaceOptions::sharedPixels,
                      {{"1", 1}, {"2", 2}, {"4", 4}, {"8", 8}, {"16", 16}},
                      "number of neighbouring pixels that share their eye walks; 1: no sharing");
    table.include("", &SubspaceOptions::merging, mergeOptions());
    return methodRow(
        {.name = "sharebpt",
         .reference = "Bekaert02",
         .summary = "spcbpt whose neighbouring pixels share eye walks",
         .techniques = {.hits = true, .connects = true, .splats = true},
         .emission = Emission::Learned,
         .sampling = Sampling::Sobol,
         .needs = {{"subspaces", "train.",
                    trainingOptions(
                        {.paths = 64'000, .subspaces = 200, .lightPaths = 260'000, .epochs = 10})
                        .options()}}},
        table, subspaceConnections);
}

}  // namespace lacuna
