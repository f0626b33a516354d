// Options of the rows that merge. (theory.md, "Merging")
#pragma once

#include "libcore/base/options.h"
#include "libcore/bidir/merging.h"

namespace lacuna {

/// `radius`, of every row that may merge.
template <class Record, class Field>
void addMergeRadius(OptionTable<Record>& table, Field field) {
    table
        .real("radius", field, 0, 1e9, "scene units",
              "within which photons are merged with an eye vertex, in the first iteration; it "
              "shrinks with each iteration; 0: two footprints of a pixel")
        .standardText("two footprints of a pixel");
}

/// Merging of rows with a pool, for paths that their connections cannot make.
struct MergeOptions {
    bool on = false;
    double radius = 0;

    Merging merging() const { return {on ? Merges::BetweenDeltas : Merges::Nowhere, radius}; }
};
/// `merge` and `radius`.
OptionTable<MergeOptions> mergeOptions();

}  // namespace lacuna
