// Connections by subspaces, which the rows spcbpt, spcbpt-fifo and sharebpt are made of.
#pragma once

#include <cstdint>
#include <memory>

#include "libcore/methods/registry.h"
#include "libcore/resampling/merge_options.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

enum class SubspaceWeights { Ris, Paper };

struct SubspaceOptions {
    std::uint64_t subpaths = 100'000;  ///< M
    PickOptions picks = {.connections = 3, .first = 12, .deep = 1};
    SubspaceWeights weights = SubspaceWeights::Ris;
    std::uint64_t reuse = 0;  ///< M_0, 0: none
    bool queue = false;       ///< keep M_0 vertices, not whole iterations: biased
    MergeOptions merging = {};
    int sharedPixels = 1;  ///< Sharing::pixels
};
/// The options that all these rows have: `candidates`, picks and `weights`.
OptionTable<SubspaceOptions> subspaceOptions(const SubspaceOptions& defaults);

std::unique_ptr<Method> subspaceConnections(const SubspaceOptions& options);

}  // namespace lacuna
