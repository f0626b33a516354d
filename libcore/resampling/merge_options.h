// What rows that merge have in common. (theory.md, "Merging")
#pragma once

#include "libcore/base/options.h"
#include "libcore/bidir/merging.h"

namespace lacuna {

/// `radius`, of every row that may merge.
template <class Record, class Field>
void addMergeRadius(OptionTable<Record>& table, Field field) {
    table
        .real(
            "radius", field, 0, 1e9, "scene units",
            "around an eye vertex in which photons are merged with it, in the first iteration; it "
            "shrinks from one to the next; 0: of two pixels")
        .standardText("of two pixels");
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
