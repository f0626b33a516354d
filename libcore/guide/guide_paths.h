// How many paths guides are learned from, of emission and of walks alike.
#pragma once

#include <cstdint>
#include <string>

#include "libcore/base/options.h"

namespace lacuna {

/// The number of paths that is asked for. If that is 0, half of those that subspaces are trained
/// with, or 500 000 if no subspaces are trained.
inline std::uint64_t guidePaths(std::uint64_t asked, std::uint64_t trainingPaths) {
    if (asked > 0) return asked;
    return trainingPaths > 0 ? (trainingPaths + 1) / 2 : 500'000;
}

/// The option that asks for them: NAME_paths, "to learn WHAT from".
template <class Record, class Field>
OptionTable<Record> withGuidePaths(OptionTable<Record> table, const std::string& name, Field field,
                                   const std::string& what) {
    table
        .integer(name, field, 0, 1e8, "full paths",
                 "to learn " + what +
                     " from; 0: half as many as train.paths, or 500000 if there is no train.paths")
        .standardText("half of train.paths");
    return table;
}

}  // namespace lacuna
