// How subspaces are trained: one table that lacuna-train, lacuna-render's spcbpt and the cache's
// key share. The seed is not among them: training with any seed serves all renders.
// (theory.md, "Subspaces")
#pragma once

#include <cstdint>

#include "libcore/base/options.h"

namespace lacuna {

struct TrainingSettings {
    std::uint64_t paths = 1'000'000;
    std::uint32_t subspaces = 1000;
    std::uint64_t lightPaths = 2'000'000;
    int epochs = 20;
    bool borrow = true;
};

inline OptionTable<TrainingSettings> trainingOptions(const TrainingSettings& defaults = {}) {
    return OptionTable<TrainingSettings>(defaults)
        .integer("paths", &TrainingSettings::paths, 1, 1e8, "full paths", "to train with")
        .integer("subspaces", &TrainingSettings::subspaces, 1, 4000, "subspaces",
                 "of light and of eye subpaths")
        .integer("light_paths", &TrainingSettings::lightPaths, 1, 1e9, "light subpaths", "for Q")
        .integer("epochs", &TrainingSettings::epochs, 0, 10'000, "passes",
                 "over the paths to optimise Gamma")
        .onOff("borrow", &TrainingSettings::borrow,
               "columns of Gamma with few paths borrow from their neighbours; off, with epochs=0: "
               "Gamma^full as the paper counts it");
}

}  // namespace lacuna
