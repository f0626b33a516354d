// Vertex connection and merging [Georgiev12b], [Hachisuka12]: bpt (own_light_path.h), and every eye
// vertex is merged with the photons around it, the vertices of all pixels' light subpaths. The
// weights cover both. (theory.md, "vcm")
#include "libcore/methods/registry.h"
#include "libcore/resampling/merge_options.h"
#include "libcore/resampling/own_light_path.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

namespace {

struct Options {
    bool nextEvent = true;
    Lamps lamps = Lamps::Seen;
    double radius = 0;
};

}  // namespace

MethodRow vcmRow() {
    OptionTable<Options> table;
    addNextEvent(table, &Options::nextEvent, &Options::lamps);
    addMergeRadius(table, &Options::radius);
    return methodRow(
        {.name = "vcm",
         .reference = "Georgiev12b",
         .summary =
             "vertex connection and merging: bpt, and merges eye vertices with photons around them",
         .techniques = {.hits = true,
                        .connects = true,
                        .splats = true,
                        .ownLightPath = true,
                        // Photons make those paths, and for less. (theory.md, "vcm")
                        .chains = false,
                        .refractions = false,
                        .knownWays = false}},
        table, [](const Options& o) {
            return makeOwnLightPath({o.nextEvent, o.lamps, {Merges::Everywhere, o.radius}});
        });
}

}  // namespace lacuna
