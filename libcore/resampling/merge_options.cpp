#include "libcore/resampling/merge_options.h"

namespace lacuna {

OptionTable<MergeOptions> mergeOptions() {
    OptionTable<MergeOptions> table;
    table.onOff("merge", &MergeOptions::on,
                "on: eye vertices between mirrors or smooth glass on both sides are merged with "
                "the pool's photons around them; the picture is then consistent, not unbiased");
    addMergeRadius(table, &MergeOptions::radius);
    return table;
}

}  // namespace lacuna
