// Resampling-aware weights [Nabata20a]: light vertices are resampled at cache points, under weights
// that know how much better a resampled vertex is than a random one. See cache_resampling.h. The
// second row is the paper's counterexample [Nabata20a Fig. 3]. It takes Q from the current pool, so
// its weights depend on the light paths that they weigh. (theory.md, "risbpt")
#include "libcore/methods/registry.h"
#include "libcore/resampling/cache_resampling.h"

namespace lacuna {

namespace {
using Options = CacheResamplingOptions;
}

MethodRow risbptRow() {
    OptionTable<Options> table =
        awareResamplingOptions({.subpaths = 200, .weights = Options::Weights::Ris});
    addEarlierIterations(table, &Options::earlierIterations);
    table.include("", &Options::merging, mergeOptions());
    table.choice<Options::Weights>(
        "weights", &Options::weights,
        {{"ris", Options::Weights::Ris}, {"plain", Options::Weights::Plain}},
        "density that the weights use: resampling-aware, or r = 1");
    return methodRow(
        {.name = "risbpt",
         .reference = "Nabata20a",
         .summary =
             "resamples light vertices at cache points, with weights that know of the resampling",
         .techniques = {.hits = true, .connects = true, .splats = true},
         .paper = {"first_connections=0", "eye_share=0", "lamps=power", "next_event=off",
                   "q_iterations=1"}},
        table, makeCacheResampling);
}

MethodRow risbptCurrentRow() {
    return methodRow(
        {.name = "risbpt-current",
         .reference = "Nabata20a",
         .summary =
             "risbpt that takes Q from the light paths that it weighs, to show the bias (Fig. 3)",
         // Splats come before the pool is complete: they would see another Q, and the weights
         // of a path would not add up to one. Without splats, Q alone causes the bias.
         .techniques = {.hits = true, .connects = true},
         .biased = true,
         .paper = {"first_connections=0", "eye_share=0", "lamps=power", "next_event=off"}},
        awareResamplingOptions(
            {.subpaths = 200, .weights = Options::Weights::Ris, .currentQ = true}),
        makeCacheResampling);
}

}  // namespace lacuna
