// Bidirectional path tracing [Veach97 10], [Lafortune93]: every eye vertex is connected with the pixel's own light
// subpath. See own_light_path.h. (theory.md, "bpt")
#include "libcore/methods/registry.h"
#include "libcore/resampling/own_light_path.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

MethodRow bptRow() {
    using Options = OwnLightPathOptions;
    OptionTable<Options> table;
    addNextEvent(table, &Options::nextEvent, &Options::lamps);
    return methodRow(
        {.name = "bpt",
         .reference = "Veach97",
         .summary = "bidirectional path tracing: joins every eye vertex with the pixel's own light "
                    "subpath",
         .techniques = {.hits = true, .connects = true, .splats = true, .ownLightPath = true}},
        table, makeOwnLightPath);
}

}  // namespace lacuna
